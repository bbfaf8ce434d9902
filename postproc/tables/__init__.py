"""Tables from the files of runs: summaries, histories, depths, updates, films."""
