"""What runs: the case as the engine sees it, the chain of a run, cycles, wear step, ledgers, states, solver, decks."""
