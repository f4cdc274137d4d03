#!/usr/bin/env python3
"""remote.py GICODEC TESTDATA: containers on servers, by nginx and by servers with faults."""
import json
import os
import re
import resource
import shutil
import socket
import subprocess
import sys
import tempfile
import time

from remote_servers import Faulty, Nginx

gicodec, testdata = map(os.path.abspath, sys.argv[1:3])
if not (shutil.which("nginx") or os.path.exists("/usr/sbin/nginx")):
    print("skipped: there is no nginx")
    sys.exit(77)
work = tempfile.mkdtemp()
os.chdir(work)
failures = 0


def check(good, what):
    global failures
    if not good:
        failures += 1
        print(f"FAILED: {what}", file=sys.stderr)


def run(*arguments, code=0, says=()):
    done = subprocess.run([gicodec, *arguments], capture_output=True, text=True, timeout=120)
    what = f"gicodec {' '.join(arguments)}: {done.returncode} {done.stderr}"
    check(done.returncode == code, what)
    for text in says:
        check(text in done.stderr, f"{what}lacks {text}")
    return done


def make(name, frames, size, *flags, textures=("a", "b")):
    """A container of noise, so many frames."""
    os.makedirs(f"{name}.dumps")
    for texture in textures:
        for frame in range(frames):
            with open(f"{name}.dumps/{texture}.{frame:05}.raw", "wb") as file:
                file.write(os.urandom(size * size * 4))
        with open(f"{name}.dumps/{texture}.json", "w") as file:
            json.dump({"format": "VK_FORMAT_R8G8B8A8_UNORM", "extent": [size, size]}, file)
    run("encode", "-q", "--gop", "20", *flags, "-o", f"site/{name}.gic", f"{name}.dumps/")


def brought(log):
    return sum(size for _, _, size in log)


os.makedirs("site")
make("long", 3000, 8)
make("wide", 12, 128)
run("encode", "-q", "-o", "site/tomb.gic", f"{testdata}/tomb-converged/")
# Cut into regions, of which those that do not change have no packets.
run("encode", "-q", "--region", "3x2x3", "-o", "site/cut_up.gic", f"{testdata}/tomb-converged/")
run("verify", "-q", "site/cut_up.gic", f"{testdata}/tomb-converged/")
make("cut_fine", 10, 256, "--block", "32x32x1", "--region", "2x2x1", textures=("fine",))
run("encode", "-q", "--region", "3x", "-o", "no.gic", f"{testdata}/tomb-converged/", code=2,
    says=["such as 8x8x8"])
nginx = Nginx(os.path.join(work, "site"), work)
try:
    # Small: head and end are all of it, or nearly.
    url = f"{nginx.origin}/tomb.gic"
    run("verify", "-q", url, f"{testdata}/tomb-converged/")
    run("verify", "-q", f"{nginx.origin}/cut_up.gic", f"{testdata}/tomb-converged/")
    check(all(status == 206 for status, _, _ in nginx.log()), "parts are asked for")

    # By the index alone, and the same as of the file.
    size = os.path.getsize("site/long.gic")
    told = json.loads(run("info", "--format", "json", f"{nginx.origin}/long.gic",
                          says=["in 2 round trips"]).stdout)
    log = nginx.log()
    here = json.loads(run("info", "--format", "json", "site/long.gic").stdout)
    check(told["by_index"] and not here["by_index"], "info says what it read")
    for field in ("frames", "first_frame", "last_frame", "bytes", "finished"):
        check(told[field] == here[field], f"info agrees about {field}")
    for there, local in zip(told["textures"], here["textures"]):
        check(there["all"]["packets"] == local["all"]["packets"] == 3000, "packets")
        check(there["keyframes"]["packets"] == local["keyframes"]["packets"], "keyframes")
        check(0 <= there["all"]["bytes"] - local["all"]["bytes"] <= 29 * 3000, "bytes of packets")
    check(brought(log) <= 170 << 10 and len(log) <= 7, f"info of {size} bytes: {log}")

    # Any frame: head and end, parts of the index, packets.
    for frame in (0, 1, 1499, 2999):
        done = run("decode", "--frames", f"{frame}", "-o", f"out{frame}", f"{nginx.origin}/long.gic")
        log = nginx.log()
        trips = int(re.search(r"in (\d+) round trip", done.stderr)[1])
        check(trips <= 3, f"frame {frame}: {trips}, {log}")
        check(brought(log) <= 400 << 10, f"frame {frame}: {brought(log)} of {size} bytes")
        for texture in ("a", "b"):
            with open(f"long.dumps/{texture}.{frame:05}.raw", "rb") as one, \
                    open(f"out{frame}/{texture}.{frame:05}.raw", "rb") as two:
                check(one.read() == two.read(), f"frame {frame} of {texture}")
    run("decode", "-q", "--frames", "7", "-o", "wide7", f"{nginx.origin}/wide.gic")
    with open("wide.dumps/b.00007.raw", "rb") as one, open("wide7/b.00007.raw", "rb") as two:
        check(one.read() == two.read(), "a frame of large packets")
    nginx.log()

    # A corner of a volume that is cut costs its own bytes; the rest is zero.
    nginx.log()
    run("decode", "-q", "-o", "all", f"{nginx.origin}/cut_fine.gic")
    everything = brought(nginx.log())
    run("decode", "-q", "--box", "0-1,0-0,0-1", "-o", "corner", f"{nginx.origin}/cut_fine.gic")
    corner = brought(nginx.log())
    check(corner < everything // 2, f"a corner: {corner} of {everything} bytes")
    run("compare", "-q", "all/fine.00000.raw", "corner/fine.00000.raw", code=1)
    with open("all/fine.00003.raw", "rb") as one, open("corner/fine.00003.raw", "rb") as two:
        every, some = one.read(), two.read()
    check(some[:16] == every[:16] and set(some[len(some) // 2:]) == {0}, "a corner and zeros")
    for box, says in (("0-1,0-0,9-12", "outside"), ("1-0,0-0,0-0", "expected a box"),
                      ("0-1,0-1", "expected a box")):
        run("decode", "--box", box, "-o", "no", f"{nginx.origin}/cut_fine.gic", code=2, says=[says])
    run("decode", "--box", "0-1,0-1,0-1", "-o", "no", url, code=2, says=["encode --region"])

    run("preview", "-q", "-o", "tomb.png", url)
    run("info", f"{nginx.origin}/none.gic", code=4, says=["HTTP 404", "check the address"])
    run("info", f"{nginx.origin}/long.dumps", code=4, says=["HTTP 404"])
    # Cut off, or still growing.
    with open("site/long.gic", "rb") as file:
        whole = file.read()
    with open("site/cut.gic", "wb") as file:
        file.write(whole[:len(whole) * 2 // 3])
    nginx.log()
    run("info", f"{nginx.origin}/cut.gic", code=3, says=["its end is missing", "round trips"])
    check(brought(nginx.log()) <= 900 << 10, "a file without its end")
    run("info", "--allow-incomplete", f"{nginx.origin}/cut.gic")
    # Followed as it grows; and replaced meanwhile.
    follow = [gicodec, "decode", "-q", "--follow", "--frames", "2000-2999"]
    for name, place in (("file", "site/grows.gic"), ("url", f"{nginx.origin}/grows.gic")):
        shutil.copy("site/cut.gic", "site/grows.gic")
        with subprocess.Popen([*follow, place, "-o", f"follows_{name}"]) as process:
            with open("site/grows.gic", "ab") as file:
                for at in range(len(whole) * 2 // 3, len(whole), 99_999):
                    time.sleep(0.1)
                    file.write(whole[at:at + 99_999])
                    file.flush()
            check(process.wait(timeout=60) == 0, f"a {name} is followed to its end")
        for frame in (2000, 2345, 2999):
            with open(f"long.dumps/b.{frame:05}.raw", "rb") as one, \
                    open(f"follows_{name}/b.{frame:05}.raw", "rb") as two:
                check(one.read() == two.read(), f"frame {frame} of a {name} that grows")
    shutil.copy("site/cut.gic", "site/grows.gic")
    with subprocess.Popen([*follow, f"{nginx.origin}/grows.gic", "-o", "replaced"],
                          stderr=subprocess.PIPE, text=True) as process:
        time.sleep(1)
        with open("site/grows.new", "wb") as file:
            file.write(os.urandom(len(whole)))
        os.replace("site/grows.new", "site/grows.gic")
        _, said = process.communicate(timeout=60)
        check(process.returncode == 4 and "replaced by another file" in said, f"replaced: {said}")
    port = nginx.port
finally:
    nginx.close()
run("info", f"http://127.0.0.1:{port}/tomb.gic", code=4, says=["check address and connection"])

# Servers that lie, cut or change the file.
with open("site/wide.gic", "rb") as file:
    faulty = Faulty(file.read())
decode = ("decode", "-q", "--overwrite", "-o", "faulty")
for fault in ("sound", "whole", "once", "redirect"):
    run(*decode, f"{faulty.origin}/{fault}/x.gic")
    run("verify", "-q", f"{faulty.origin}/{fault}/x.gic", "wide.dumps/")
for fault, says in {
        "total": "changed while it was read", "mark": "changed while it was read",
        "changed": "changed while it was read", "place": "other bytes",
        "longer": "other bytes", "shorter": "other bytes", "packed": "packs it (gzip)",
        "ring": "redirects", "cut": "try again", "401": "--token-file", "404": "HTTP 404",
        "restless": "changed while it was read", "416": "empty", "503": "HTTP 503"}.items():
    run(*decode, f"{faulty.origin}/{fault}/x.gic", code=4, says=[says])
run(*decode, f"{faulty.origin}/other/x.gic", code=3)
run("info", f"{faulty.origin}/endless/x.gic", code=3, says=["is not a .gic container"])
with subprocess.Popen([gicodec, *decode, f"{faulty.origin}/endless/x.gic"], stderr=subprocess.DEVNULL) as endless:
    most = 0  # bytes in memory; sanitizers reserve more
    until = time.monotonic() + 60
    while endless.poll() is None and most < 1 << 30 and time.monotonic() < until:
        with open(f"/proc/{endless.pid}/statm") as file:
            most = max(most, int(file.read().split()[1]) * resource.getpagesize())
        time.sleep(0.01)
    endless.kill()
check(endless.returncode == 3, f"an endless file costs no memory, {most} bytes seen")

# A token goes to the server that was named, over TLS or on this machine, and to nobody else.
other = Faulty(faulty.body)
faulty.elsewhere = other.origin.replace("127.0.0.1", "localhost")
with open("token", "w") as file:
    file.write("secret-of-mine\n")
os.chmod("token", 0o600)
faulty.requests.clear()
run("info", "--token-file", "token", f"{faulty.origin}/redirect/x.gic")
sent = [headers.get("Authorization") for _, headers in faulty.requests]
check(sent and all(one == "Bearer secret-of-mine" for one in sent), f"the token is sent: {sent}")
check(other.requests and all("secret-of-mine" not in str(headers) for _, headers in other.requests),
      "a redirect gets no token")
check(all("Referer" not in headers for _, headers in other.requests), "nor the address before it")
for host in ("example.invalid", "localhost.example.invalid", "127.0.0.1.example.invalid"):
    run("info", "--token", "x", f"http://{host}/x.gic", code=2, says=["in clear", "https://"])
os.environ["http_proxy"] = other.origin
other.requests.clear()
run("info", "--token-file", "token", f"{faulty.origin}/sound/x.gic")
check(not other.requests, "no proxy sees the token")
del os.environ["http_proxy"]

# A file that grows faster than answers come.
growing = Faulty(whole)
run("decode", "--follow", "--frames", "2000-2999", "-o", "grows", f"{growing.origin}/grows/x.gic")
for frame in (2000, 2345, 2999):
    with open(f"long.dumps/b.{frame:05}.raw", "rb") as one, \
            open(f"grows/b.{frame:05}.raw", "rb") as two:
        check(one.read() == two.read(), f"frame {frame} of a file that grows with each request")
check(len(growing.requests) < 200, f"{len(growing.requests)} requests for it")

# A server that is away for a moment is waited for; one that never answers does not keep a user.
run(*decode, "--follow", f"{faulty.origin}/away/x.gic")
run("info", "--quiet", f"{faulty.origin}/whole/x.gic")
run(*decode, "--follow", f"{faulty.origin}/whole/x.gic", code=4, says=["--follow needs parts"])
with socket.create_server(("127.0.0.1", 0)) as silent:
    with subprocess.Popen([gicodec, "info", f"http://127.0.0.1:{silent.getsockname()[1]}/x.gic"],
                          stderr=subprocess.DEVNULL) as process:
        time.sleep(0.5)
        process.terminate()
        begun = time.monotonic()
        process.wait(timeout=20)
        check(time.monotonic() - begun < 5, "a signal ends what waits for a server")
# A file here that is followed, and is cut or removed.
for change in (lambda: os.truncate("site/grows.gic", 1000), lambda: os.remove("site/grows.gic"),
               lambda: os.replace("site/tomb.gic", "site/grows.gic")):
    shutil.copy("site/cut.gic", "site/grows.gic")
    with subprocess.Popen([*follow, "site/grows.gic", "-o", "gone"], stderr=subprocess.PIPE,
                          text=True) as process:
        time.sleep(1)
        change()
        _, said = process.communicate(timeout=30)
        check(process.returncode == 4 and "replaced, cut or removed" in said, f"gone: {said}")
    shutil.rmtree("gone", ignore_errors=True)
hidden = run("info", f"http://user:word@127.0.0.1:{port}/x.gic?key=mine", code=4)
check("word" not in hidden.stderr and "mine" not in hidden.stderr, "messages show no secrets")

shutil.rmtree(work)
sys.exit(1 if failures else 0)
