# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A slow link between a client and its server: what goes through comes later, and counts. It is a program,
for ParaView's Python waits for its server without letting other threads run."""

import socket
import subprocess
import sys
import threading
import time


class SlowLink:
    """A link to a port of this machine, in a process of its own; `port` is its own port. To be used
    within a with statement. What goes through comes `delay` seconds later."""

    def __init__(self, target, delay=0.05):
        self.target = target
        self.delay = delay

    def __enter__(self):
        self.process = subprocess.Popen([sys.executable, __file__, str(self.target), str(self.delay)],
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.port = int(self.process.stdout.readline())
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.communicate()

    def count(self):
        """Bytes that the client has sent and received so far."""
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        return [int(number) for number in self.process.stdout.readline().split()]


class Link:
    """Passes on what comes to a port of its own to a port of this machine: each direction `delay`
    seconds later, and at most `rate` bytes a second. `counts` are the bytes that the client has
    sent and received so far."""

    def __init__(self, port, delay=0.05, rate=20e6 / 8):
        self.target = port
        self.delay = delay
        self.rate = rate
        self.counts = [0, 0]
        self.listener = socket.create_server(("localhost", 0))
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        """Connect each client to the server."""
        while True:
            client, _ = self.listener.accept()
            server = socket.create_connection(("localhost", self.target))
            for each in (client, server):
                each.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            for direction, (a, b) in enumerate(((client, server), (server, client))):
                threading.Thread(target=self.carry, args=(direction, a, b), daemon=True).start()

    def carry(self, direction, source, target):
        """Read, and let another thread write when the time has come."""
        queue = []
        ready = threading.Condition()

        def write():
            while True:
                with ready:
                    while not queue:
                        ready.wait()
                    when, data = queue.pop(0)
                time.sleep(max(0.0, when - time.monotonic()))
                try:
                    if not data:
                        target.shutdown(socket.SHUT_WR)
                        return
                    target.sendall(data)
                except OSError:
                    return

        threading.Thread(target=write, daemon=True).start()
        free = 0.0  # when the link has carried all that it was given
        data = b"-"
        while data:
            try:
                data = source.recv(65536)
            except OSError:
                data = b""
            self.counts[direction] += len(data)
            free = max(free, time.monotonic()) + len(data) / self.rate
            with ready:
                queue.append((free + self.delay, data))
                ready.notify()


if __name__ == "__main__":
    own = Link(int(sys.argv[1]), float(sys.argv[2]))
    print(own.listener.getsockname()[1], flush=True)
    for _ in sys.stdin:
        print(*own.counts, flush=True)
