"""What each family of screens wants to be told; needed once, when the screen is made.

    usart-gpu   "Usart GPU" (stm32.sinaapp.com): CLS, DSnn, DRn, TPN, BTN; answers OK; touch as [BN:n]
    uart-lcd    "HFD / HF0xx UART LCD": CLR, DCnn, DIR; answers OK; no touch
    nextion     Nextion and TJC: a page with texts t0 to t4 and buttons of component numbers 1 (stop) and 2 (auto)

Source: the vendors' command lists; they disagree from unit to unit, so the dialect must be tried.
"""

# kind: (commands at the start, before a text with %d for the line's y or number, after it)
_DIALECTS = {
    "usart-gpu": (
        (b"CLS(0);DR1;TPN(2);\r\n", b"BTN(1,0,180,150,239,1);BOXF(0,180,150,239,1);DS24(45,198,'STOP',15);\r\n",
         b"BTN(2,170,180,319,239,1);BOXF(170,180,319,239,2);DS24(215,198,'AUTO',15);\r\n"),
        "BOXF(0,%d,319,%d,0);DS16(4,%d,'", b"',15);\r\n",
    ),
    "uart-lcd": (
        (b"CLR(0);DIR(1);\r\n",),
        "BOXF(0,%d,319,%d,0);DC16(4,%d,'", b"',15);\r\n",
    ),
    "nextion": (
        (b"bkcmd=0\xff\xff\xff",),
        't%d.txt="', b'"\xff\xff\xff',
    ),
}  # fmt: skip


def commands(kind, lines):
    """(commands at the start, what goes before the text of each line, all joined and each as long as the others, after it), bytes."""
    start, before, after = _DIALECTS[kind]
    befores = b""
    for line in range(lines):
        y = 10 + 18 * line  # two digits each
        befores += (before % (line if kind == "nextion" else (y, y + 17, y))).encode()
    return list(start), befores, after


def hearing(kind):
    """The function that follows the touches, or None."""
    if kind == "usart-gpu":
        from link.touch_brackets import hear
    elif kind == "nextion":
        from link.touch_nextion import hear
    else:
        hear = None
    return hear


def texts(width):
    """(the texts of reasons and faults, as much of each as a line shows, one after the other; where each ends; number of the first fault)."""
    from array import array

    from link.reason_texts import FAULTS, REASONS

    every = [(text or "").encode()[:width] for text in REASONS + FAULTS]
    ends = array("H", bytes(2 * len(every)))
    end = 0
    for k in range(len(every)):
        end += len(every[k])
        ends[k] = end
    return b"".join(every), ends, len(REASONS)
