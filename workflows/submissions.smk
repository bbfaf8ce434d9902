"""What a cluster gets as one submission; included after all rules, before the targets of the studies."""

# All tables and figures of a study are one: jobs of seconds would wait longer than they take. What runs where snakemake
# was called is in none.
for RULE in workflow.modifier.rules:  # not those of a Snakefile that takes this one as a module
    if NAMING.ours(RULE.name) not in {*BEFORE_TABLES, "printed_page"}:
        RULE.group = "tables_and_figures"
