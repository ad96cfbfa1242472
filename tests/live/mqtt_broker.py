"""A broker that can be stopped and started again, and a client that keeps its subscription meanwhile (MQTT 3.1.1)."""
import json
import socket
import struct
import subprocess
import threading
import time

from trial import insist, start

CONNECT, SUBSCRIBE, PUBACK, PUBLISH = 0x10, 0x82, 0x40, 3


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Broker:
    """Mosquitto on the loopback interface. It stores sessions, so it keeps messages for an absent client."""

    def __init__(self, work):
        self.port = free_port()
        self.config = work / "mosquitto.conf"
        store = work / "mosquitto"
        store.mkdir()
        self.config.write_text(f"listener {self.port} 127.0.0.1\nallow_anonymous true\npersistence true\n"
                               f"persistence_location {store}/\nmax_queued_messages 0\nuser root\n")

    def start(self):
        self.process = start(["mosquitto", "-c", self.config], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = time.monotonic() + 10
        while time.monotonic() < end:
            try:
                socket.create_connection(("127.0.0.1", self.port), 1).close()
                return
            except OSError:
                time.sleep(0.02)
        insist(False, "mosquitto does not listen")

    def stop(self):
        self.process.terminate()
        self.process.wait(20)


def text(word):
    return struct.pack("!H", len(word)) + word.encode()


class Subscriber:
    """Receives all messages below a topic, with the time of arrival in ns since 1970. It connects again when the broker was away."""

    def __init__(self, port, topic):
        self.port, self.topic, self.messages, self.is_ready = port, topic, [], threading.Event()
        threading.Thread(target=self.work, daemon=True).start()
        insist(self.is_ready.wait(10), "no subscription")

    def work(self):
        while True:
            try:
                with socket.create_connection(("127.0.0.1", self.port), 5) as self.connection:
                    self.connection.settimeout(None)
                    self.receive()
            except OSError:
                time.sleep(0.05)

    def send(self, kind, body):
        self.connection.sendall(bytes([kind, len(body)]) + body)  # all of its packets are short

    def read(self, size):
        data = b""
        while len(data) < size:
            more = self.connection.recv(size - len(data))
            if not more:
                raise OSError("closed")
            data += more
        return data

    def receive(self):
        self.send(CONNECT, text("MQTT") + bytes([4, 0, 0, 0]) + text("trial"))  # no clean session, no keep-alive
        self.send(SUBSCRIBE, struct.pack("!H", 1) + text(self.topic + "/#") + bytes([1]))
        while True:
            kind, size, shift = self.read(1)[0], 0, 0
            while True:
                byte = self.read(1)[0]
                size |= (byte & 127) << shift
                shift += 7
                if byte < 128:
                    break
            now, body = time.time_ns(), self.read(size)
            if kind >> 4 == PUBLISH:
                self.take(now, kind, body)
            self.is_ready.set()

    def take(self, now, kind, body):
        end = 2 + struct.unpack("!H", body[:2])[0]
        topic, has_number = body[2:end].decode(), kind & 6
        if has_number:
            self.send(PUBACK, body[end:end + 2])
            end += 2
        self.messages.append((now, topic, body[end:].decode()))

    def below(self, word):
        """Returns time and content of the messages of `TOPIC/word`."""
        return [(at, json.loads(content)) for at, topic, content in list(self.messages) if topic == f"{self.topic}/{word}"]

    def frames(self):
        """Returns the frames of all rows that arrived."""
        return {frame for _, rows in self.below("rows") for frame in rows["frame"]}
