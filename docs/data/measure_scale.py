"""measure_scale.py discovery|page [--bin build/release/bin]: two costs of docs/data/scale.json.

discovery   idle drivers, each on a host of its own (a network namespace; needs root and iproute2): bytes per second and pair of processes
page        a demo with --robots N and one page, a WebSocket client (needs python3-websocket): bytes per second and robot
"""
import argparse
import contextlib
import re
import subprocess
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def sh(*words):
    return subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True).stdout


@contextlib.contextmanager
def hosts(number):
    """Network namespaces sc0, sc1, ... with 10.99.6.1, ... on one bridge."""
    try:
        sh("ip", "netns", "add", "scsw")
        sh("ip", "-n", "scsw", "link", "add", "br0", "up", "type", "bridge")
        for i in range(number):
            sh("ip", "netns", "add", f"sc{i}")
            sh("ip", "-n", f"sc{i}", "link", "add", "eth0", "type", "veth", "peer", "name", f"p{i}", "netns", "scsw")
            sh("ip", "-n", "scsw", "link", "set", f"p{i}", "master", "br0", "up")
            sh("ip", "-n", f"sc{i}", "addr", "add", f"10.99.6.{i + 1}/24", "dev", "eth0")
            for link in ("eth0", "lo"):
                sh("ip", "-n", f"sc{i}", "link", "set", link, "up")
        yield
    finally:
        for name in ["scsw", *(f"sc{i}" for i in range(number))]:
            subprocess.run(["ip", "netns", "del", name], stderr=subprocess.DEVNULL, check=False)


def sent(number):
    """Bytes that all hosts sent."""
    lines = (sh("ip", "netns", "exec", f"sc{i}", "cat", "/proc/net/dev") for i in range(number))
    return sum(int(re.search(r"eth0:(.*)", text).group(1).split()[8]) for text in lines)


def measure_discovery(bin_folder, number, with_peers):
    peers = ", ".join(f"10.99.6.{i + 1}" for i in range(number))
    bus = "interface: eth0" + (f"\n      peers: [{peers}]" if with_peers else "")
    text = (ROOT / "deploy/config/robot.yaml").read_text()
    with hosts(number), tempfile.TemporaryDirectory() as folder:
        drivers = []
        for i in range(number):
            config = Path(folder, f"{i}.yaml")
            config.write_text(re.sub(r'interface: "".*', bus, text).replace("robot: r1", f"robot: r{i + 1}").replace("/tb3", f"/tb{i}"))
            drivers.append(subprocess.Popen(["ip", "netns", "exec", f"sc{i}", bin_folder / "conav-driver", "--config", config], stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL))
        time.sleep(25.0)
        start = sent(number)
        time.sleep(20.0)
        rate = (sent(number) - start) / 20.0
        for driver in drivers:
            driver.terminate()
        codes = [driver.wait() for driver in drivers]
    pairs = number * (number - 1)
    print(f"{number} hosts, {'peers' if with_peers else 'multicast'}: {rate / 1e3:.1f} kB/s in all, {rate / pairs:.0f} B/s a pair; first 25 s {(start - 25.0 * rate) / pairs:.0f} B a pair", "" if not any(codes) else codes)


def measure_page(bin_folder, robots):
    import websocket  # here, as discovery does without
    demo = subprocess.Popen([bin_folder / "conav", "demo", "--headless", "--robots", str(robots), "--speed", "1", "--seed", "7", "--console", "8099", "--time-limit", "120"], stdout=subprocess.DEVNULL)
    try:
        for _ in range(100):
            with contextlib.suppress(OSError):
                socket = websocket.create_connection("ws://127.0.0.1:8099/ws", origin="http://127.0.0.1:8099")
                break
            time.sleep(0.2)

        def field(number, data):
            return bytes([number << 3 | 2, len(data)]) + data

        socket.send_binary(field(1, field(2, b"measure") + field(3, b"0123456789abcdef")))  # ClientMessage.hello
        begin, pinged, received = time.time(), 0.0, 0
        while time.time() < begin + 75.0:
            if time.time() > pinged + 0.5:
                socket.send_binary(field(2, b""))  # ping
                pinged = time.time()
            data = socket.recv()
            received += len(data) if time.time() > begin + 15.0 else 0
        print(f"{robots} robots: {received / 60.0 / robots:.0f} B/s a robot, without pictures")
    finally:
        demo.terminate()
        demo.wait()


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("what", choices=["discovery", "page"])
parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin")
parser.add_argument("--robots", type=int, default=12, help="of page")
parser.add_argument("--hosts", type=int, nargs="+", default=[4, 8, 16], help="of discovery")
options = parser.parse_args()
if options.what == "page":
    measure_page(options.bin, options.robots)
else:
    for peers in (True, False):
        for count in options.hosts:
            measure_discovery(options.bin, count, peers)
