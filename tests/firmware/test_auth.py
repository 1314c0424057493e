"""auth.py: the code that commands carry over the network."""

from link.auth import hmac_sha256, same, tag


def test_hmac_of_rfc_4231():
    cases = (
        (b"\x0b" * 20, b"Hi There", "b0344c61d8db38535ca8afceaf0bf12b881dc200c9833da726e9376c2e32cff7"),
        (b"Jefe", b"what do ya want for nothing?", "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843"),
        (
            b"\xaa" * 131,
            b"Test Using Larger Than Block-Size Key - Hash Key First",
            "60e431591ee0b67f0d8a26aacbf5b77f8e0bc6213728c5140546040f0ee37f54",
        ),
    )
    for key, message, expected in cases:
        assert hmac_sha256(key, message).hex() == expected


def test_tag_depends_on_everything():
    plain = tag(b"k" * 32, b"s" * 8, b"command")
    assert len(plain) == 8
    assert plain == tag(b"k" * 32, b"s" * 8, bytearray(b"command"))
    assert plain != tag(b"K" * 32, b"s" * 8, b"command")
    assert plain != tag(b"k" * 32, b"S" * 8, b"command")
    assert plain != tag(b"k" * 32, b"s" * 8, b"Command")


def test_same():
    assert same(b"12", b"12") and not same(b"12", b"13") and not same(b"12", b"123") and same(b"", b"")
