"""Publisher and viewers beside a server of NATS that is full, forgets, or has been told nonsense.

    nats_faults.py FOLDER   of gi-server and gi-client
"""
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import urllib.request

from nats_nodes import Alone, Nats

programs = sys.argv[1]
if not shutil.which("nats-server"):
    print("skipped: nats-server is not installed")
    sys.exit(77)
work = tempfile.mkdtemp(prefix="gicodec-nats-faults-")
running, nodes, failures = [], [], 0
SCENE = ["--scene", "tomb"]


def check(good, what):
    global failures
    if not good:
        failures += 1
        print(f"FAILED: {what}", file=sys.stderr)


def serve(memory):
    nodes.append(Alone(work, memory))
    nodes[-1].start()
    return nodes[-1]


def publish(node, name, *flags):
    log = open(os.path.join(work, f"{name}.log"), "w")
    process = subprocess.Popen([os.path.join(programs, "gi-server"), "--nats", node.url, *SCENE, "--grid", "8x4x8", "--rate", "20", "--proofs",
                                "--nats-max-mb", "4", *flags], stdout=subprocess.DEVNULL, stderr=log)
    process.log = log.name
    running.append(process)
    return process


def log_of(process):
    with open(process.log) as file:
        return file.read()


def logged(process, text, seconds=30):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if text in log_of(process):
            return True
        time.sleep(0.05)
    return False


def view(node, *flags):
    process = subprocess.Popen([os.path.join(programs, "gi-client"), "--nats", node.url, *SCENE, "--expect-proofs",
                                "--subscribe", "all", "--stats", "json", *flags], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    running.append(process)
    return process


def end(process, what):
    out, errors = process.communicate(timeout=60)
    check(process.returncode == 0, f"{what}: exit code {process.returncode}: {errors}")
    said = json.loads(out) if out.startswith("{") else {}
    check(said.get("proofs", 0) > 0 and said.get("failed_proofs") == 0, f"{what}: {said}")
    return said


def too_small():
    node = serve("1MB")
    refused = publish(node, "too-small")
    check(refused.wait(30) == 4 and "--nats-max-mb" in log_of(refused), log_of(refused))
    node.stop()


def becomes_full(node):
    """Another stream takes all that is left; live viewers notice nothing."""
    ports = os.path.join(work, "ports")
    publisher = publish(node, "full", "--snapshot-seconds", "1", "--listen-web", "127.0.0.1:0", "--insecure-web",
                        "--port-file", ports)
    check(logged(publisher, "listening"), log_of(publisher))
    live = view(node, "--seconds", "8")
    time.sleep(1)
    with open(ports) as file:
        web = file.read().split()[-1]
    with urllib.request.urlopen(f"http://127.0.0.1:{web}/metrics") as answer:
        metrics = answer.read().decode()
    check('gicodec_published_bytes_total{type="snapshot"}' in metrics and "gicodec_unstored_messages" in metrics, metrics)
    other = Nats(node)
    made = other.request("$JS.API.STREAM.CREATE.other", json.dumps(
        {"name": "other", "subjects": ["other"], "storage": "memory", "retention": "limits"}).encode())
    check(made is not None and b'"error"' not in made, made)
    stored = 0
    while b'"error"' not in (other.request("other", bytes(200_000)) or b'"error"'):
        stored += 1
    check(stored > 10, f"{stored} messages fill it")
    check(logged(publisher, "does not store messages"), log_of(publisher))
    end(live, "a viewer of servers that are full")
    check(b'"success":true' in (other.request("$JS.API.STREAM.DELETE.other") or b""), "the other stream is deleted")
    check(logged(publisher, "stores messages again"), log_of(publisher))
    end(view(node, "--updates", "20"), "who comes when there is room again")
    other.close()
    return publisher


def forgets(node, publisher):
    live = view(node, "--seconds", "4")
    time.sleep(1.5)
    node.kill()
    node.start()
    check(logged(publisher, "NATS is reached again"), log_of(publisher))
    check(end(live, "a viewer of a server that was killed").get("longest_pause_ms", 9e9) < 2000, "it goes on within 2 s")
    end(view(node, "--updates", "20"), "who comes to a server that has forgotten all")


def loses_streams(node, publisher):
    """Somebody deletes them."""
    other = Nats(node)
    for name in ("gicodec-last", "gicodec-updates"):
        check(b'"success":true' in (other.request(f"$JS.API.STREAM.DELETE.{name}") or b""), f"{name} is deleted")
    deadline = time.monotonic() + 15
    while not other.request("$JS.API.DIRECT.GET.gicodec-last.gicodec.list") and time.monotonic() < deadline:
        time.sleep(0.2)
    other.close()
    end(view(node, "--updates", "20"), "who comes after the streams were deleted")


def is_told_nonsense(node):
    """By somebody who may publish."""
    hostile, numbers = Nats(node), random.Random(7)
    for subject in ("gicodec.list", "gicodec.tick", "gicodec.world.>"):
        hostile.subscribe(subject, 1)
    viewers = [view(node, "--seconds", "4") for _ in range(2)]
    until = time.monotonic() + 3
    while time.monotonic() < until:
        seen = hostile.next(1)
        if not seen or seen[0] != "MSG" or not seen[2] or numbers.random() < 0.5:
            continue
        data = bytearray(seen[2])
        for _ in range(numbers.randint(1, 4)):
            data[numbers.randrange(len(data))] = numbers.randrange(256)
        hostile.publish(seen[1], bytes(data[:numbers.randint(1, len(data))] if numbers.random() < 0.3 else data))
    hostile.close()
    for one in viewers:
        one.communicate(timeout=60)
        check(one.returncode >= 0, f"a viewer of nonsense ends by signal {-one.returncode}")


def clock_is_behind(node, publisher):
    """The last publisher's clock was far ahead."""
    publisher.send_signal(signal.SIGINT)
    check(publisher.wait(20) == 0, log_of(publisher))
    other = Nats(node)
    other.request("gicodec.publisher", b"1099511627776")
    later = publish(node, "later")
    check(logged(later, "listening"), log_of(later))
    claim = other.request("$JS.API.DIRECT.GET.gicodec-last.gicodec.publisher")
    check(claim == b"1099511627777", f"the next epoch is {claim}")
    other.close()
    end(view(node, "--updates", "20"), "a viewer of a publisher whose clock is behind")


try:
    too_small()
    node = serve("24MB")
    publisher = becomes_full(node)
    forgets(node, publisher)
    loses_streams(node, publisher)
    is_told_nonsense(node)
    publisher.kill()
    publisher.wait()
    publisher = publish(node, "again")
    check(logged(publisher, "listening"), log_of(publisher))
    clock_is_behind(node, publisher)
finally:
    for process in running:
        if process.poll() is None:
            process.kill()
    for node in nodes:
        node.stop()
    if failures == 0 and sys.exc_info()[0] is None:
        shutil.rmtree(work)
    else:
        print(f"logs are in {work}", file=sys.stderr)
sys.exit(1 if failures else 0)
