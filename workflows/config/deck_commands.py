"""What a project's own templates leave out of the package's: commands without which a deck runs on, but not as it did.

Templates are read as text, with all branches of their Jinja and what they include, so no run is needed.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from bulkwear.workflows.engine.project import Project, template_files

INCLUDE = re.compile(r"""{%-?\s*include\s+["']([^"']+)["'][^%]*%}""")
JINJA = re.compile(r"{%.*?%}|{#.*?#}", re.DOTALL)
EXPRESSION = re.compile(r"{{-?\s*(.*?)\s*-?}}", re.DOTALL)
CONTINUED = re.compile(r"&\s*\n\s*")
CONDITIONAL = re.compile(r'\bthen\s+"([^"]*)"')  # a command that `if` runs
NAMED = ("fix", "compute", "dump", "write_dump", "write_restart")  # commands whose first word is a name, or a file's
LISTED = {"thermo_style": 2}  # commands of which each word from that one on counts: columns that tables are made of
OTHERS = {  # commands that count by their word alone
    *("units", "atom_style", "atom_modify", "boundary", "newton", "communicate", "hard_particles", "processors"),
    *("pair_style", "pair_coeff", "neighbor", "neigh_modify", "timestep", "thermo", "thermo_modify", "dump_modify"),
    *("read_restart", "read_data", "reset_timestep", "create_box", "create_atoms", "delete_atoms", "set", "velocity"),
    "run",
}
MOST_NAMED = 6  # commands in a sentence


def left_out(project: Project) -> list[str]:
    """Return a sentence for each template of a project that stands before one of the package and lacks commands that
    the package's has, in itself or in what it includes.
    """
    if project.is_package:
        return []
    theirs = {name: project.package / path for name, path in template_files(project.package).items()}
    own = {name: project.folder / path for name, path in template_files(project.folder).items()}
    sentences = []
    for name in sorted(own.keys() & theirs.keys()):
        alone = {**own, **theirs, name: own[name]}  # what own partials leave out is told of them
        there = {*commands(name, {**theirs, **own}), *commands(name, alone)}
        missing = [command for command in commands(name, theirs) if command not in there]
        if missing:
            more = f" and {len(missing) - MOST_NAMED} more" if len(missing) > MOST_NAMED else ""
            shown = own[name].relative_to(project.folder).as_posix()
            sentences.append(f"{shown}: without {', '.join(missing[:MOST_NAMED])}{more} of the package's deck")
    return sentences


def commands(name: str, files: Mapping[str, Path]) -> list[str]:
    """Return the commands of a template in their order, each once: its word, and its name where it has one.

    files: of all templates by the names that they are found by
    """
    text = EXPRESSION.sub(lambda found: "{" + "".join(found[1].split()) + "}", JINJA.sub("", whole_text(name, files)))
    lines = [line.strip() for line in CONTINUED.sub(" ", text).splitlines()]
    lines = [line for line in lines if line and not line.startswith("#")]
    lines += [each for line in lines for each in CONDITIONAL.findall(line)]
    return list(dict.fromkeys(command for line in lines for command in _told(line.split("#")[0].split())))


def whole_text(name: str, files: Mapping[str, Path], within: tuple[str, ...] = ()) -> str:
    """Return the text of a template with what it includes in its place; within: templates that include it."""
    if name not in files or name in within:
        return ""
    text = files[name].read_text("utf-8-sig", "replace")
    return INCLUDE.sub(lambda found: whole_text(found[1], files, (*within, name)), text)


def _told(words: list[str]) -> list[str]:
    """Return what counts of a command's words."""
    if not words:
        return []
    if words[0] in LISTED:
        return [f"{words[0]} {word}" for word in words[LISTED[words[0]] :]]
    return [" ".join(words[:2])] if words[0] in NAMED else [words[0]] if words[0] in OTHERS else []
