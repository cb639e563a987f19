"""The run `forge` of `line_faults`: a stranger who sits in the line while a map is sent, hears, holds back and changes every
frame, makes each fit its CRCs, and lacks the code."""
import binascii
import hashlib
import shutil
import struct

import modbus_host as modbus
from faulty_line import HOST, OTHER, UNIT, Delivery, Faults
from upload_runs import UploadRun

NEUTRAL = bytes.fromhex("410671DB01")  # changed so, five bytes keep their CRC-32
assert binascii.crc32(NEUTRAL) == binascii.crc32(bytes(5))
AT_PAYLOAD = 6 + 2 * 6  # of the request that writes a block
SEALED = (modbus.RESULT, modbus.ACK, modbus.SESSION, modbus.ACTIVE_MAP, modbus.CHECKS, modbus.MEMORY)
KINDS = {}


def kind(is_its=lambda forger, to, pdu: True):
    """@param is_its  whether a frame is one of those that this kind spoils"""
    def register(function):
        def act(forger, to, pdu):
            return function(forger, to, pdu) if is_its(forger, to, pdu) else None

        KINDS[function.__name__.replace("_", " ")] = act
        return act

    return register


def request(block):
    return lambda forger, to, pdu: forger.writes(to, pdu, block)


def answer(block=None):
    return lambda forger, to, pdu: forger.answers(to, pdu, block)


def with_words(pdu, at, words):
    """@param at  of the first register, in the answer or in what is written"""
    head = 2 if pdu[0] == 23 and len(pdu) == 2 + pdu[1] else 10 if pdu[0] == 23 else 6
    data = modbus.bytes_of(words)
    return pdu[:head + 2 * at] + data + pdu[head + 2 * at + len(data):]


def spliced(before, pdu, join):
    """With a part of a frame of before; None: there was none as long."""
    return [join(before)] if before and len(before) == len(pdu) else None


def flipped(forger, pdu, at, count):
    """One bit of `count` registers from there on."""
    where = at + forger.rng.randrange(count)
    old = modbus.words_of(pdu[-2 * forger.words(pdu):])[where]
    return with_words(pdu, where, [old ^ 1 << forger.rng.randrange(16)])


# Each: what comes instead of the request (to: UNIT) or of the answer (to: HOST); None: this frame is none of its.

@kind(request(modbus.BLOCK))
def block_changed_crc_kept(forger, to, pdu):
    if len(pdu) < AT_PAYLOAD + len(NEUTRAL):
        return None
    at = forger.rng.randrange(AT_PAYLOAD, len(pdu) - len(NEUTRAL) + 1)
    changed = bytes(a ^ b for a, b in zip(pdu[at:], NEUTRAL))
    return [pdu[:at] + changed + pdu[at + len(NEUTRAL):]]


@kind(request(modbus.BLOCK))
def block_added(forger, to, pdu):
    check = forger.rng.choice((pdu[10:18], forger.rng.randbytes(8), bytes(8)))
    return [pdu[:10] + check + forger.rng.randbytes(len(pdu) - AT_PAYLOAD), pdu]


@kind(request(modbus.BLOCK))
def block_of_another_number(forger, to, pdu):
    return [flipped(forger, pdu, 1, 1)]


@kind(request(modbus.BLOCK))
def blocks_exchanged(forger, to, pdu):
    """The payload of the block before, with its check."""
    before, forger.before = forger.before, pdu
    return spliced(before, pdu, lambda old: pdu[:10] + old[10:])


@kind(request(modbus.WINDOW))
def window_moved(forger, to, pdu):
    return [flipped(forger, pdu, 5, 9)]


@kind(request(modbus.COMMAND))
def command_changed(forger, to, pdu):
    return [flipped(forger, pdu, 5, 14)]


@kind(request(modbus.COMMAND))
def command_of_zeros_key(forger, to, pdu):
    words = modbus.words_of(pdu[10:])
    words[7] = forger.rng.choice((modbus.COMMIT, modbus.ABANDON, modbus.BEGIN, modbus.OUTPUT, words[7]))
    return [with_words(pdu, 0, modbus.sealed(words[:-4], modbus.OF_COMMAND, None)), pdu]


@kind(answer())
def answer_changed(forger, to, pdu):
    return [flipped(forger, pdu, 1, forger.words(pdu) - 1)]


@kind(answer())
def answer_without_check(forger, to, pdu):
    return [with_words(flipped(forger, pdu, 1, forger.words(pdu) - 5), forger.words(pdu) - 4, [0] * 4)]


@kind(answer())
def answer_of_before(forger, to, pdu):
    """The answer to the same question of before, with the echo of this one."""
    before = forger.old.get(forger.asked)
    forger.old[forger.asked] = pdu
    return spliced(before, pdu, lambda old: with_words(old, 0, modbus.words_of(pdu[2:4])))


@kind(answer(modbus.ACTIVE_MAP))
def said_to_be_active(forger, to, pdu):
    """The active map is named as that which is to be sent, from the first question on."""
    return [forger.named_as_sent(pdu)]


@kind()
def said_to_be_done(forger, to, pdu):
    """The commit never arrives; its result and the active map are as if it had."""
    if forger.writes(to, pdu, modbus.COMMAND) and modbus.words_of(pdu[10:])[7] == modbus.COMMIT:
        forger.held_back = True
        return [with_words(pdu, 7, [modbus.ABANDON])]
    if forger.held_back and forger.answers(to, pdu, modbus.RESULT):
        return [with_words(pdu, 5, [modbus.DONE, 0, 1000])]
    if forger.held_back and forger.answers(to, pdu, modbus.ACTIVE_MAP):
        return [forger.named_as_sent(pdu)]
    return None


@kind()
def said_to_have_arrived(forger, to, pdu):
    """Blocks are kept back, and acknowledged."""
    if forger.writes(to, pdu, modbus.BLOCK):
        return [pdu[:AT_PAYLOAD] + bytes(len(pdu) - AT_PAYLOAD)]
    if forger.answers(to, pdu, modbus.ACK):
        return [with_words(pdu, 3, [0])[:2 + 2 * 8] + b"\xFF" * 8 + pdu[2 + 2 * 12:]]
    return None


@kind(answer(modbus.SESSION))
def session_of_another(forger, to, pdu):
    return [flipped(forger, pdu, 3, 17)]


@kind()
def exchange_changed(forger, to, pdu):
    """Shares, confirmations, points of low order and of no order in an exchange of keys."""
    low = modbus.words_of(forger.rng.choice((bytes(32), b"\xFF" * 32, b"\1" + bytes(31), forger.rng.randbytes(32))))
    if forger.writes(to, pdu, modbus.ARM_SHARE):
        words = modbus.words_of(pdu[10:])
        return [with_words(pdu, 0, modbus.checked(words[:4] + low))]
    if forger.writes(to, pdu, modbus.ARM_CONFIRM):
        return [flipped(forger, pdu, 3, 8)]
    if forger.answers(to, pdu, modbus.ARM_ANSWER):
        return [with_words(pdu, 3, low)] if forger.rng.random() < 0.5 else [with_words(pdu, 1, [0])]
    return None


@kind()
def version_lowered(forger, to, pdu):
    if forger.answers(to, pdu, modbus.SESSION) or forger.answers(to, pdu, modbus.IDENTITY):
        return [with_words(pdu, 1, [2])]
    return None


class Forger(Faults):
    def __init__(self, rng, name, image):
        self.rng, self.label, self.act, self.image = rng, name, KINDS[name], image
        self.likelihood = rng.choice((0.1, 0.5, 1.0))
        self.asked, self.before, self.held_back, self.old, self.did = None, None, False, {}, 0

    @staticmethod
    def words(pdu):
        """Registers of an answer, or those that a request writes."""
        return (len(pdu) - (2 if len(pdu) == 2 + pdu[1] else 10)) // 2 if pdu[0] == 23 else (len(pdu) - 6) // 2

    @staticmethod
    def writes(to, pdu, block):
        at = 5 if pdu[0] == 23 else 1
        return to == UNIT and pdu[0] in (16, 23) and struct.unpack(">H", pdu[at:at + 2])[0] == block

    def answers(self, to, pdu, block=None):
        whole = to == HOST and pdu[0] == 23 and len(pdu) == 2 + pdu[1] and pdu[1] > 10
        return whole and (self.asked == block if block is not None else self.asked in SEALED)

    def named_as_sent(self, pdu):
        digest = modbus.words_of(hashlib.sha256(self.image).digest())
        commit = modbus.words_of(pdu[2 + 2 * 14:2 + 2 * 16])
        pdu = with_words(pdu, 14, modbus.long(modbus.number(commit) + self.held_back) + modbus.long(len(self.image)))
        return with_words(pdu, 18, digest)

    def deliveries(self, line, sender, frame):
        to, pdu = OTHER[sender], frame[7:] if line.tcp else frame[1:-2]
        if to == UNIT and len(pdu) > 5 and pdu[0] == 23:
            self.asked = struct.unpack(">H", pdu[1:3])[0]
        instead = None
        if len(pdu) > 2 and self.rng.random() < self.likelihood:
            instead = self.act(self, to, pdu)
        if instead is None:
            return super().deliveries(line, sender, frame)
        self.did += 1
        transaction = struct.unpack(">H", frame[:2])[0]
        return [Delivery(modbus.tcp_frame(one, frame[6], transaction) if line.tcp else modbus.rtu_frame(one, frame[0]), to,
                         0.01 * k) for k, one in enumerate(instead)]


class Forge(UploadRun):
    """One kind a trial; sometimes `ecs` has no secret yet and must be armed over the same line."""

    def trial(self, rng):
        before, sent = self.drawn(rng)
        self.prepare(before, sent, rng.choice(("zeros", "other", "part")))
        name = list(KINDS)[self.options.number % len(KINDS)]
        if name == "exchange changed" or rng.random() < 0.1:
            shutil.rmtree(self.place.dir / "state", ignore_errors=True)
        faults = Forger(rng, name, self.maps.images[sent])
        ending = self.send(sent, faults)
        yield name, self.verdict(ending, before, sent), ending, {"forged": faults.did}
