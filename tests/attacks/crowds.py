"""What many hosts without the code do to a unit on TCP at one time, each crowd a process of its own; used by `attacks`.

    for crowd in CROWDS: with beside(port, crowd): ...
"""
import contextlib
import multiprocessing
import os
import random
import select
import socket
import time

import modbus_host as modbus

CONNECTS_A_SECOND = 1000  # of all crowds
OPEN_AT_MOST = 400  # of connections that ask nothing
PIPELINED = 100  # requests that are sent before the first reply is read
HELD = 8  # connections of one crowd


def origin(k):
    """Of a stranger: never that of `ecs`."""
    return "127.1.%d.%d" % (k // 250 % 250, 1 + k % 250)


def connects(port, over, rate=CONNECTS_A_SECOND):
    """Connections at their rate, which ask nothing and are dropped when there are many."""
    held, begun, made = [], time.monotonic(), 0
    while not over.is_set():
        while made < rate * (time.monotonic() - begun) and not over.is_set():
            made += 1
            connection = socket.socket()
            connection.bind((origin(0), 0))
            connection.setblocking(False)
            connection.connect_ex(("127.0.0.1", port))
            held.append(connection)
            if len(held) > OPEN_AT_MOST:
                held.pop(0).close()
        time.sleep(0.001)
    return made


def askers(port, over, rate=CONNECTS_A_SECOND):
    """Connections at their rate, from many addresses; each reads the status once and stays."""
    held, begun, made = [], time.monotonic(), 0
    request = modbus.tcp_frame(modbus.fc3(modbus.STATUS, 58))
    while not over.is_set():
        while made < rate * (time.monotonic() - begun) and not over.is_set():
            made += 1
            connection = socket.socket()
            with contextlib.suppress(OSError):
                connection.bind((origin(made), 0))
                connection.settimeout(0.2)
                connection.connect(("127.0.0.1", port))
                connection.sendall(request)
            held.append(connection)
            if len(held) > OPEN_AT_MOST:
                held.pop(0).close()
        time.sleep(0.001)
    return made


def flood(port, over, request, count=HELD, origins=1):
    """Requests by request(k), many under way on each connection; a connection that was closed is made again."""
    sent, links = 0, {}
    while not over.is_set():
        while len(links) < count:
            with contextlib.suppress(OSError):
                link = modbus.connected_to(port, origin(random.randrange(origins)))
                link.setblocking(False)
                links[link] = b""
        readable, writable, _ = select.select(list(links), list(links), [], 0.1)
        for link in set(readable) | set(writable):
            try:
                if link in readable and not link.recv(1 << 16):
                    raise OSError("closed")
                if link in writable:
                    if not links[link]:
                        links[link] = b"".join(request(sent + k) for k in range(PIPELINED))
                        sent += PIPELINED
                    links[link] = links[link][link.send(links[link]):]
            except BlockingIOError:
                pass
            except OSError:
                link.close()
                del links[link]
    return sent


def session_of(port):
    return modbus.Host(port=port, origin=origin(0)).look()


def readers(port, over):
    """Status, events, monitor and memory, eight hosts at once."""
    pdus = [modbus.fc3(modbus.STATUS, 58), modbus.fc3(modbus.EVENTS, 96), modbus.fc3(0x200, 69),
            modbus.fc23(modbus.MEMORY, 125, modbus.SELECT, [0] + modbus.long(modbus.BANK[1]) + [240])]
    frames = [modbus.tcp_frame(pdu) for pdu in pdus]
    return flood(port, over, lambda k: frames[k % len(frames)])


def checkers(port, over):
    """Checks of as much memory as the unit allows, and the active map with its SHA-256."""
    host = session_of(port)

    def request(k):
        if k % 2:
            return modbus.tcp_frame(modbus.fc3(modbus.ACTIVE_MAP, 38))
        block = host.block(modbus.CHECK, modbus.long(modbus.BANK[1]) + modbus.long(16384))
        return modbus.tcp_frame(modbus.fc23(modbus.RESULT, modbus.RESULT_COUNT, modbus.COMMAND, block))

    return flood(port, over, request)


def sessions(port, over):
    """A new session with every request."""
    host = session_of(port)

    def request(_):
        host.key, host.number = random.getrandbits(64), random.getrandbits(32)
        return modbus.tcp_frame(modbus.fc23(modbus.SESSION, modbus.SESSION_COUNT, modbus.SESSION_OPEN,
                                            host.session_block()))

    return flood(port, over, request)


def exchanges(port, over):
    """Exchanges of keys, and wrong codes, from 200 addresses."""
    host = session_of(port)
    share = modbus.cpace.Exchange("000000", "", host.session, 1).share
    begin = modbus.checked([0] + modbus.long(host.session) + [1] + modbus.words_of(share))
    guess = modbus.checked([0] + modbus.long(host.session) + modbus.words_of(bytes(16)))

    def request(k):
        if k % 2:
            return modbus.tcp_frame(modbus.fc23(modbus.ARM_ANSWER, 29, modbus.ARM_CONFIRM, guess))
        return modbus.tcp_frame(modbus.fc23(modbus.ARM_ANSWER, 29, modbus.ARM_SHARE, begin))

    return flood(port, over, request, count=200, origins=200)


def stops(port, over):
    """Commands that the unit refuses, and so notes."""
    host = session_of(port)
    return flood(port, over, lambda k: modbus.tcp_frame(modbus.fc23(
        modbus.RESULT, modbus.RESULT_COUNT, modbus.COMMAND, host.block(modbus.OUTPUT, modbus.output(k % 3, k, True)))))


def half_connects(port, over):
    return connects(port, over, CONNECTS_A_SECOND / 2)


def half_askers(port, over):
    return askers(port, over, CONNECTS_A_SECOND / 2)


CROWDS = (connects, askers, readers, checkers, sessions, exchanges, stops)
TOGETHER = (half_connects, half_askers) + CROWDS[2:]


def member(crowd, port, over, counts, seed):
    """Of lower priority than the programs under test: a crowd has computers of its own."""
    os.nice(10)
    random.seed(seed)
    counts.put((crowd.__name__, crowd(port, over)))


@contextlib.contextmanager
def beside(port, crowds, counts=None):
    """The crowds do what they do while the context lasts; counts: filled with how often each did it."""
    over, queue = multiprocessing.Event(), multiprocessing.Queue()
    processes = [multiprocessing.Process(target=member, args=(crowd, port, over, queue, random.getrandbits(32)))
                 for crowd in crowds]
    for process in processes:
        process.start()
    try:
        yield
    finally:
        over.set()
        for process in processes:
            process.join(5)
            if process.is_alive():
                process.kill()
        while counts is not None and not queue.empty():
            name, count = queue.get()
            counts[name] = counts.get(name, 0) + count
