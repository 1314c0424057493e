"""HFD, HF0xx UART LCD: CLR, BOXF, DCnn, DIR; answers OK; no touch that is documented. See screen_usart_gpu.py."""

COLOURS = (0, 2, 1, 3, 4, 7, 15, 6)
DRAWING = b"""BOXF(\x01,\x02,\x03,\x04,\x07);
BOXF(0,\x02,239,\x04,0);DC16(\x01,\x02,'\x08',\x07);
DC16(4,280,'no touch: page or button',7);
"""
START = b"""CLR(0);
DIR(0);
"""
