"""Nextion and TJC: fill, xstr with the page's font 0, sendxy; told not to answer; touch as coordinates. Colours are RGB565. See screen_usart_gpu.py."""

COLOURS = (0, 0x4CED, 0xF9E7, 0x4C1F, 0xFE60, 0x7BEF, 0xFFFF, 0xF81F)
DRAWING = b"""fill \x01,\x02,\x05,\x06,\x07\xff\xff\xff
xstr \x01,\x02,236,18,0,\x07,0,0,1,1,"\x08"\xff\xff\xff
xstr 0,256,80,64,0,65535,51525,1,1,1,"STOP"\xff\xff\xffxstr 80,256,80,64,0,65535,1026,1,1,1,"START"\xff\xff\xffxstr 160,256,80,64,0,65535,27469,1,1,1,"SET"\xff\xff\xff
"""
START = b"""\xff\xff\xffbkcmd=0\xff\xff\xffsendxy=1\xff\xff\xff
cls 0\xff\xff\xff
"""
