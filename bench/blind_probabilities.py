"""What the probabilities of several blind checks were worth together, and what chance alone would have made of them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from app.blind.calibration import Claim, error, honest
from bench.blind_pages import Check, Figure, Worth, count


def pooled(checks: Sequence[Check]) -> list[Worth]:
    """The ranges of all checks that have them, added up, the highest probability first."""
    pieces = [piece for check in checks for piece in check.worth]
    spans = sorted({piece.span for piece in pieces}, key=lambda span: float(span.split()[0]), reverse=True)
    return [_sum([piece for piece in pieces if piece.span == span]) for span in spans]


def _sum(pieces: Sequence[Worth]) -> Worth:
    of = sum(piece.true.of for piece in pieces)
    said = sum(piece.said * piece.true.of for piece in pieces) / of
    return Worth(pieces[0].span, said, count(sum(piece.true.hits for piece in pieces), of))


def claims_of(pieces: Sequence[Worth]) -> list[Claim]:
    """The causes named, each with the mean of what was said in its range, which is all that a page keeps."""
    return [(piece.said, k < piece.true.hits) for piece in pieces for k in range(piece.true.of)]


def calibration_error(pieces: Sequence[Worth]) -> Figure | None:
    """Of the sum, and what chance alone makes of probabilities that are all true; None without a cause named."""
    return error_of(claims_of(pieces))


def error_of(claims: Sequence[Claim]) -> Figure | None:
    """The same of claims as they were made."""
    if not claims:
        return None
    found, chance = error(claims), honest(claims)["mean"]
    return Figure(f"{found:.3f}", found, interval=f"{len(claims)} causes, {chance:.3f} by chance")


def words(pieces: Sequence[Worth]) -> Iterator[str]:
    """The calibration error of the sum beside that of probabilities that are all true."""
    claims = claims_of(pieces)
    chance = honest(claims)
    low, high = chance["range95"]
    yield f"Calibration error over {len(claims)} causes named: {error(claims):.3f}. Were every probability true,"
    yield f"chance alone would make it {chance['mean']:.3f} in the mean, {low:.3f} to {high:.3f} in 95 of 100 draws,"
    yield f"and at least as large as found in {100.0 * chance['above']:.0f} of 100.\n"
