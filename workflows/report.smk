rule report:
    output: "results/{study}/report.html"
    shell: "touch {output}"
