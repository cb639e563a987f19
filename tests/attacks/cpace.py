#!/usr/bin/python3
"""The exchange of keys of docs/protocol.md, written from the documents alone: ristretto255 (RFC 9496) and CPace
(draft-irtf-cfrg-cpace, CPACE-RISTR255-SHA512). Not in constant time: for tests only.

The vectors of the draft (section "Test vector for CPace using group ristretto255 and hash SHA-512"):
>>> CI, SID = bytes.fromhex("0b415f696e69746961746f720b425f726573706f6e646572"), bytes.fromhex("7e4b4791d6a8ef019b936c79fb7f2c57")
>>> encode(generator(b"Password", CI, SID)).hex()
'222b6b195fe84b1652badb6f6a3ae3d24341e7306967f0b8115b40d5698c7e56'
>>> ya = int.from_bytes(bytes.fromhex("da3d23700a9e5699258aef94dc060dfda5ebb61f02a5ea77fad53f4ff0976d08"), "little")
>>> yb = int.from_bytes(bytes.fromhex("d2316b454718c35362d83d69df6320f38578ed5984651435e2949762d900b80d"), "little")
>>> a, b = (encode(times(y, generator(b"Password", CI, SID))) for y in (ya, yb))
>>> a.hex()[:16], b.hex()[:16]
('d6bac480f2c386c3', '3ea7e0b19560d7c0')
>>> encode(times(ya, decode(b))).hex() == encode(times(yb, decode(a))).hex() == "80b69a8a76457ab6a4d7f887a4bf6b55a2f80ac19c333f917a05fc9887c8b40f"
True
>>> shared_key(encode(times(ya, decode(b))), SID, a, b"ADa", b, b"ADb").hex()[:32]
'b69effbf61b51d56401c0f65601abe42'
>>> decode(bytes.fromhex("2b3c6b8c4f3800e7aef6864025b4ed79bd599117e427c41bd47d93d654b4a51c")) is None, encode(decode(bytes(32))) == bytes(32)
(True, True)
"""
import hashlib
import hmac
import random

P = 2**255 - 19
L = 2**252 + 27742317777372353535851937790883648493
D = -121665 * pow(121666, -1, P) % P
ROOT = pow(2, (P - 1) // 4, P)  # of -1
ONE_MINUS_D_SQ, D_MINUS_ONE_SQ = (1 - D * D) % P, (D - 1) ** 2 % P
NEUTRAL = (0, 1, 1, 0)


def negative(x):
    return x % P & 1


def magnitude(x):
    return (P - x) % P if negative(x) else x % P


def sqrt_ratio(u, v):
    """(whether u/v is a square, its root that is not negative, or that of ROOT u/v)"""
    r = u * v**3 * pow(u * v**7, (P - 5) // 8, P) % P
    check = v * r * r % P
    right, flipped, flipped_root = check == u % P, check == -u % P, check == -u * ROOT % P
    if flipped or flipped_root:
        r = r * ROOT % P
    return right or flipped, magnitude(r)


SQRT_AD_MINUS_ONE = P - sqrt_ratio(-D - 1, 1)[1]
INVSQRT_A_MINUS_D = sqrt_ratio(1, -1 - D)[1]
if SQRT_AD_MINUS_ONE != 25063068953384623474111414158702152701244531502492656460079210482610430750235:
    SQRT_AD_MINUS_ONE = P - SQRT_AD_MINUS_ONE


def added(p, q):
    """Twisted Edwards, a = -1, in extended coordinates (RFC 8032, 5.1.4)."""
    a, b = (p[1] - p[0]) * (q[1] - q[0]) % P, (p[1] + p[0]) * (q[1] + q[0]) % P
    c, d = 2 * p[3] * q[3] * D % P, 2 * p[2] * q[2] % P
    e, f, g, h = b - a, d - c, d + c, b + a
    return e * f % P, g * h % P, f * g % P, e * h % P


def times(scalar, point):
    product = NEUTRAL
    for bit in bin(scalar % L)[2:]:
        product = added(product, product)
        if bit == "1":
            product = added(product, point)
    return product


def decode(octets):
    """Nothing where the octets are no point."""
    s = int.from_bytes(octets, "little")
    if s >= P or s & 1:
        return None
    u1, u2 = (1 - s * s) % P, (1 + s * s) % P
    v = (-(D * u1 * u1) - u2 * u2) % P
    square, root = sqrt_ratio(1, v * u2 * u2)
    x = magnitude(2 * s * root * u2)
    y = u1 * root * root * u2 * v % P
    t = x * y % P
    return (x, y, 1, t) if square and not negative(t) and y else None


def encode(point):
    x0, y0, z0, t0 = point
    u1, u2 = (z0 + y0) * (z0 - y0) % P, x0 * y0 % P
    _, root = sqrt_ratio(1, u1 * u2 * u2)
    d1, d2 = root * u1 % P, root * u2 % P
    z_inverse = d1 * d2 * t0 % P
    x, y, d = (y0 * ROOT % P, x0 * ROOT % P, d1 * INVSQRT_A_MINUS_D % P) if negative(t0 * z_inverse) else (x0, y0, d2)
    if negative(x * z_inverse):
        y = -y
    return magnitude(d * (z0 - y)).to_bytes(32, "little")


def mapped(octets):
    t = int.from_bytes(octets, "little") % 2**255
    r = ROOT * t * t % P
    u, v = (r + 1) * ONE_MINUS_D_SQ % P, (-1 - r * D) * (r + D) % P
    square, s = sqrt_ratio(u, v)
    s, c = (s, -1) if square else ((P - magnitude(s * t)) % P, r)
    n = (c * (r - 1) * D_MINUS_ONE_SQ - v) % P
    w0, w1, w2, w3 = 2 * s * v, n * SQRT_AD_MINUS_ONE, 1 - s * s, 1 + s * s
    return w0 * w3 % P, w2 * w1 % P, w1 * w3 % P, w0 * w2 % P


def with_length(octets):
    length, head = len(octets), b""
    while length >= 0x80:
        head, length = head + bytes([length & 0x7F | 0x80]), length >> 7
    return head + bytes([length]) + octets


def generator(code, channel, session):
    head = with_length(b"CPaceRistretto255") + with_length(code)
    text = head + with_length(bytes(max(0, 128 - len(head) - 1))) + with_length(channel) + with_length(session)
    digest = hashlib.sha512(text).digest()
    return added(mapped(digest[:32]), mapped(digest[32:]))


def shared_key(point, session, host_share, host_data, unit_share, unit_data):
    head = with_length(b"CPaceRistretto255_ISK") + with_length(session) + with_length(point)
    return hashlib.sha512(head + b"".join(map(with_length, (host_share, host_data, unit_share, unit_data)))).digest()


def confirmation(key, session, share, data):
    mac_key = hashlib.sha512(b"CPaceMac" + session + key).digest()
    return hmac.new(mac_key, with_length(share) + with_length(data), hashlib.sha512).digest()[:16]


class Exchange:
    """The host's side of an exchange with a unit."""

    def __init__(self, code, serial_number, session, minutes):
        self.session, self.host_data, self.unit_data = b"%08x" % session, b"%d min" % minutes, serial_number.encode()
        self.scalar = random.randrange(1, L)
        self.share = encode(times(self.scalar, generator(
            code.encode(), b"ECS host, ECS unit " + serial_number.encode(), self.session)))

    def confirms(self, unit_share):
        """(what the host sends, what the unit has to answer); afterwards the secret is known."""
        point = encode(times(self.scalar, decode(unit_share)))
        key = shared_key(point, self.session, self.share, self.host_data, unit_share, self.unit_data)
        self.secret = hashlib.blake2b(b"ECS secret of an armed host", key=key, digest_size=32).digest()
        return (confirmation(key, self.session, self.share, self.host_data),
                confirmation(key, self.session, unit_share, self.unit_data))


def session_key(secret, session, nonce):
    return hashlib.blake2b(session.to_bytes(4, "big") + nonce.to_bytes(8, "big") + b"ECS session",
                           key=secret, digest_size=32).digest()


def keyed_check(key, kind, octets):
    """Kinds: 1 window, 2 block, 3 command, 4 answer, 5 piece of memory. Null key: the one of zeros."""
    return hashlib.blake2b(bytes([kind]) + octets, key=key or bytes(32), digest_size=32).digest()[:8]


if __name__ == "__main__":
    import doctest
    import sys
    sys.exit(1 if doctest.testmod().failed else 0)
