"""What a screen shows: 240 x 320 pixels, upright."""

import base64
import functools
import io

from PIL import Image, ImageDraw, ImageFont

WIDE, HIGH = 240, 320
BEZEL, ROUND = 14, 10  # of the case in a picture, pixels


class Glass:
    """The pixels. changes: counts what was painted, so that others see when it looks different. Every method returns how many pixels it painted."""

    def __init__(self):
        self.image = Image.new("RGB", (WIDE, HIGH))
        self._draw = ImageDraw.Draw(self.image)
        self.changes = 0

    def clear(self, colour):
        """All of it in one colour, (r, g, b)."""
        return self.box(0, 0, WIDE - 1, HIGH - 1, colour)

    def box(self, x1, y1, x2, y2, colour):
        """A filled box, its corners included."""
        self.changes += 1
        self._draw.rectangle((x1, y1, x2, y2), fill=colour)
        return max(x2 - x1 + 1, 0) * max(y2 - y1 + 1, 0)

    def text(self, x, y, text, high, colour):
        """Text of characters as high as given and half as wide, its upper left corner at x, y; nothing behind it is painted."""
        self.changes += 1
        font = _font(high)
        for k, letter in enumerate(text):
            self._draw.text((x + (k + 0.5) * high / 2, y + high * 0.78), letter, font=font, fill=colour, anchor="ms")
        return len(text) * high * high // 2

    def png(self):
        """The pixels as PNG in base64, a str."""
        data = io.BytesIO()
        self.image.save(data, "PNG")
        return base64.b64encode(data.getvalue()).decode()

    def picture(self, scale=2):
        """An Image of the screen in its case."""
        shown = self.image.resize((scale * WIDE, scale * HIGH), Image.Resampling.NEAREST)
        around = scale * BEZEL
        out = Image.new("RGB", (shown.width + 2 * around, shown.height + 2 * around), "#ffffff")
        ImageDraw.Draw(out).rounded_rectangle((0, 0, out.width - 1, out.height - 1), scale * ROUND, fill="#2b2d33")
        out.paste(shown, (around, around))
        return out


@functools.cache
def _font(high):
    import matplotlib

    return ImageFont.truetype(f"{matplotlib.get_data_path()}/fonts/ttf/DejaVuSansMono{'-Bold' if high > 16 else ''}.ttf", round(high * 0.8))
