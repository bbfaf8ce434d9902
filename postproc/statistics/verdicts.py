"""Verdicts on published findings: confirmed, not confirmed, or that nothing can be said, with the reason."""

from __future__ import annotations

from dataclasses import dataclass

CONFIRMED, REFUTED, UNSAID = "confirmed", "not confirmed", "cannot be said"


@dataclass(frozen=True)
class Verdict:
    """What was found, in words with numbers, the verdict, and the reason where nothing can be said."""

    found: str
    verdict: str
    reason: str = ""
