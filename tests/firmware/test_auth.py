"""auth.py: the code that commands carry over the network."""

from link.auth import Signer


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
        signer = Signer(key)
        assert signer.digest(message).hex() == expected
        assert signer.digest(message[:5], memoryview(message)[5:]).hex() == expected


def test_tag_depends_on_everything():
    signer = Signer(b"k" * 32)
    plain = signer.tag(b"s" * 8, b"command")
    assert len(plain) == 8
    assert plain == signer.tag(b"s" * 8, bytearray(b"command"))
    assert plain != Signer(b"K" * 32).tag(b"s" * 8, b"command")
    assert plain != signer.tag(b"S" * 8, b"command")
    assert plain != signer.tag(b"s" * 8, b"Command")


def test_only_the_right_tag_signs():
    signer = Signer(b"k" * 32)
    tag = signer.tag(b"s" * 8, b"command")
    assert signer.signed(b"s" * 8, b"command", tag)
    for at in range(8):
        assert not signer.signed(b"s" * 8, b"command", tag[:at] + bytes([tag[at] ^ 1]) + tag[at + 1 :])
    for wrong in (tag[:7], tag + b"1", b""):
        assert not signer.signed(b"s" * 8, b"command", wrong)
