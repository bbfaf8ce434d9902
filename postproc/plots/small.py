"""Pictures as small files, for a page that has all of them in itself."""

from __future__ import annotations

import io
from pathlib import Path

from PIL import Image

from bulkwear.postproc.plots.style import PALETTE

SMALL_ENOUGH = 60_000  # bytes, of a picture that is left as it is
QUALITY = 88  # of WebP, at which letters stay sharp


def small_picture(path: str | Path) -> tuple[bytes, str]:
    """Return a picture and its media type: of a large PNG the smaller of WebP and of a PNG with a palette."""
    content, kind = Path(path).read_bytes(), f"image/{Path(path).suffix[1:]}"
    if kind != "image/png" or len(content) <= SMALL_ENOUGH:
        return content, kind
    image, few, webp = Image.open(path).convert("RGB"), io.BytesIO(), io.BytesIO()
    image.quantize(PALETTE, dither=Image.Dither.NONE).save(few, "PNG", optimize=True)
    image.save(webp, "WEBP", quality=QUALITY)
    return min((content, kind), (few.getvalue(), kind), (webp.getvalue(), "image/webp"), key=lambda each: len(each[0]))
