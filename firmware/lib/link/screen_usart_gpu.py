""" "Usart GPU" (stm32.sinaapp.com): CLS, BOXF, DSnn, DRn, TPN, BTN; answers OK; touch as [BN:n].

COLOURS: nothing, green, red, blue and yellow windows, other points, outline, way. DRAWING: a box, a line of text, the three buttons; START: two commands; a line each.
What the low bytes stand for: screen_kernels.emit.
"""

COLOURS = (0, 2, 1, 3, 4, 7, 15, 6)
DRAWING = b"""BOXF(\x01,\x02,\x03,\x04,\x07);
BOXF(0,\x02,239,\x04,0);DS16(\x01,\x02,'\x08',\x07);
BOXF(0,256,79,319,1);BOXF(80,256,159,319,10);BOXF(160,256,239,319,7);DS24(16,276,'STOP',15);DS24(90,276,'START',15);DS24(182,276,'SET',15);
"""
START = b"""CLS(0);DR0;TPN(2);
BTN(1,0,256,79,287,1);BTN(2,80,256,159,287,1);BTN(3,160,256,239,287,1);BTN(4,0,288,79,319,1);BTN(5,80,288,159,319,1);BTN(6,160,288,239,319,1);
"""
