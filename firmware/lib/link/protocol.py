"""The wire format between robot and laptop: one binary frame both ways, the same over USB serial and UDP.

For the laptop, and for the tests. The robot does not load this module: a public name costs it memory, so messages.py and commands.py have the
numbers they need as constants of their own, and the tests hold them against those of this page.

Frame, all fields little-endian

    offset  size
    0       2      0xF7 0xF6; neither byte can occur in UTF-8, so text printed between frames never looks like one
    2       1      version, 1
    3       1      type
    4       2      sequence number, counts the frames sent; a gap tells what was lost on the way
    6       2      length n of the payload, at most 1390: a frame fits one datagram of 1400 bytes
    8       n      payload
    8 + n   2      CRC-16 (Modbus) over bytes 2 .. 8+n-1

A datagram holds one frame; zero bytes after it are filling. Angles are 0.1 deg, clockwise positive, lengths mm in the body frame
(x right, y forward) unless said otherwise; a time is the robot's ticks_us modulo 2**30. u and i: unsigned, signed; the number: bits.

Robot to laptop

    01 HELLO       session (8 bytes), counter u32 (of the last command), tag (8 bytes, see below), then JSON: firmware (version), robot (name), board (unique id in hex),
                   boot (reason), width, length, track, spacings
    02 DECISION    number u32, time u32, state u8 (STOPPED, AUTO, MANUAL), mode u8, AF i16, AR i16, V u8, window u8, zone u8 (255 none), free i16,
                   block x i16, block y i16 (32767 none), why u8, took u32 (us of computing)
    03 WHEELS      time u32, AF i16, AR i16, (V-90)*256 i16 as the wheels stand now, folded u32 (bit k: wheel k reversed), count u8,
                   then count angles i16, then count speed shares i16 (16384 = the fastest wheel)
    04 POINTS      time u32, count u16, then count x i16, count y i16, count windows u8 (0 none 1 green 2 red 3 blue 4 yellow)
    05 SCAN        lidar frames until the end: time u32 (of the last point), first and last bearing u16, count u8, count distances u16
                   (quarter mm, 0 none); up to one revolution
    06 HEALTH      uptime ms u32, heap free u32 (bytes), worst loop us u32, battery mV u16 (0 unknown), lidar speed u8 (0.05 r/s), flags u8 (bit 0
                   lidar trusted, 1 chips answer, 2 radio on), fault u8, lidar frames u32, check errors u32, speed faults u32, frames of
                   telemetry dropped u32, commands refused u32
    07 PARAMETER   JSON: key, value, low, high, number (0 ..), of (how many there are), restart (true: counts from the next start); what it
                   means is in schema.py
    08 LOG         level u8 (0 information, 1 warning, 2 error), UTF-8 text
    09 POSE        time u32, x i32, y i32 (1/256 mm since boot), heading u32 (0.001 deg)
    0A CANDIDATES  time u32, mirroring u8, chosen u8 (255 none), count u8, then count AF i16, count AR i16, count free lengths u16 (65535: not
                   looked at, as others promised more). AF and AR are those of a right turn ahead; bit 0 of mirroring: both change their sign
                   (left), bit 1: they are exchanged with their sign changed (backward)
    0B REPLY       counter u32 and type u8 of the command, status u8 (OK, REFUSED), UTF-8 text
    0D GOAL        time u32, then 21 i16: state (0 none, 1 going, 2 there, 3 alarm, 4 looking for itself, 5 lost), alarm (0 none, 1 door shut, 2 goal walled in, 3 no progress),
                   method (0 gap, 1 field, 2 behaviour), pose (0 guessed, 1 given, 2 known, 3 lost), x, y, heading (0.1 deg), its own estimate of its error, percent of the points that fit,
                   goal x, y, steered for x, y, length of the way (1/5 cells, -1 none), door that comes next (-1 none), door being passed, how much of it is open (-1 not measured), the
                   middle of that (aside), searches, goals waiting, patrol. Only with a map; mm from the map's lower left corner
    0E CELLS       time u32, number of the first cell u16, then cells u16 as goal/kernels.py describes them: a part of all, from the lower left, row by row
    0F MAP         time u32, then bytes 4 to the last door of the map's file, goal/build.py
    0C NAMES       JSON: reasons, faults (the texts that numbers point into); only when asked for by GREET
    10 TURNS       time u32, turns of the loop u16 since the last; then for each part (see PARTS in survive.py) the sum u32 and the longest u32 of its times, us
    20 ARM_STATE   only with an arm: state u8 (off, wakes, holds, moves, plays), why u8 (what froze it last: nothing, hold, fault, link, wheels, chips), count u8, then
                   count set points i16 (0.01 deg)

Laptop to robot; each payload begins with a counter u32

    41 DRIVE       what u8 (STOPPED, AUTO, MANUAL), AF i16, AR i16, V u8. MANUAL must be repeated: 300 ms without one and the robot stops
    42 TUNE        UTF-8 text key=value, value as in JSON; takes effect at once, until the robot restarts. Some count from the next start only,
                   and only if kept: the REPLY says so
    43 KEEP        write what was tuned to robot.json on the board
    44 WATCH       flags u8: bit 0 send SCAN, bit 1 send CANDIDATES, bit 2 send TURNS
    45 LIST        send every PARAMETER
    46 POINT       wheel u8 (2(i-1)+(j-1)), angle i16: turn this wheel alone while the robot stands; its trim is the parameter servos.trims.WHEEL
    47 GREET       what u8: bit 0 send HELLO and NAMES; then 8 random bytes, the nonce (may be left out). Over UDP the robot sends to whom it last heard a valid command from, for 3 s;
                   a GREET without a right tag is answered with a HELLO, which tells the session a tag needs
    50 ARM         what u8: 0 hold, 1 go on (what moves freezes 300 ms after the last command), 2 home, 3 play (then u8, bit 0: first go slowly to where it begins),
                   4 joint (then index u8, angle i16), 5 pose (then an angle i16 for each joint); angles 0.01 deg, joints of the plane first
    51 REACH       offset u16, then bytes of a trajectory, in pieces from 0 on without a gap (layout: arm/requests.py); the last piece has it checked and kept
    49 GO          what u8 (0 give up, 1 go there, 2 there as well, later, 3 it is here, 4 go on: forget what was found and try again, 5 patrol, x 0 or 1, 6 method x,
                   7 look for yourself), x i16, y i16 (mm on the map), heading i16 (0.1 deg)
    4A MAP         first byte u16, how many u16, CRC-16 of all u16, then a part of map.bin in order; the last one puts it in place, for the next start
    48 RESTART     restart, as after a reset; refused unless the robot stands

Commands over UDP end with a tag of 8 bytes: the first 8 bytes of HMAC-SHA256 under the robot's key, see `auth`. Over USB there is none:
whoever holds the cable can also press reset.

A HELLO that answers a GREET over UDP has a tag too, if there is a key: the first 8 bytes of HMAC-SHA256 over the GREET's nonce | version and type |
session and counter | JSON. So whoever sent that nonce knows the session and the counter to be the robot's own and of now; from other HELLOs,
whose tag may be zeros, a laptop learns only that there is a robot.
"""

VERSION = 1
SYNC = b"\xf7\xf6"
HEADER = 8
CHECK = 2  # bytes of it
MAX_PAYLOAD = 1390
MAX_FRAME = 1400

HELLO = 0x01
DECISION = 0x02
WHEELS = 0x03
POINTS = 0x04
SCAN = 0x05
HEALTH = 0x06
PARAMETER = 0x07
LOG = 0x08
POSE = 0x09
CANDIDATES = 0x0A
REPLY = 0x0B
NAMES = 0x0C
TURNS = 0x10
ARM_STATE = 0x20
GOAL = 0x0D
CELLS = 0x0E
MAP = 0x0F

DRIVE = 0x41
TUNE = 0x42
KEEP = 0x43
WATCH = 0x44
LIST = 0x45
POINT = 0x46
GREET = 0x47
RESTART = 0x48
ARM = 0x50
REACH = 0x51
GO = 0x49
PUT_MAP = 0x4A

STOPPED = 0
AUTO = 1
MANUAL = 2

OK = 0
REFUSED = 1

# struct formats of the fixed parts, as listed above
DECISION_FORMAT = "<IIBBhhBBBhhhBI"
WHEELS_FORMAT = "<IhhhIB"
POINTS_FORMAT = "<IH"
SCAN_FORMAT = "<IHHB"
HEALTH_FORMAT = "<IIIHBBBIIIII"
HELLO_FORMAT = "<8sI8s"
POSE_FORMAT = "<IiiI"
ARM_STATE_FORMAT = "<BBB"
CANDIDATES_FORMAT = "<IBBB"
TURNS_FORMAT = "<IH12I"
REPLY_FORMAT = "<IBB"
COUNTER_FORMAT = "<I"
DRIVE_FORMAT = "<IBhhB"
WATCH_FORMAT = "<IB"
GREET_FORMAT = "<IB8s"
POINT_FORMAT = "<IBh"
GOAL_FORMAT = "<I21h"
CELLS_FORMAT = "<IH"
MAP_FORMAT = "<I"
GO_FORMAT = "<IBhhh"
PUT_MAP_FORMAT = "<IHHH"

NO_POINT = 32767
