"""The examples run. Those that need a server find it in the folder that GICODEC_BUILD names."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

import numpy as np
import pytest

from test_codec import recording

EXAMPLES = pathlib.Path(__file__).resolve().parent.parent / "examples"


def run(name, *arguments):
    return subprocess.run([sys.executable, EXAMPLES / name, *map(str, arguments)], check=True,
                          capture_output=True, text=True, timeout=120).stdout


def test_plot(tmp_path):
    pytest.importorskip("matplotlib")
    recording(tmp_path / "x.gic")
    run("plot.py", tmp_path / "x.gic", tmp_path / "x.png")
    assert (tmp_path / "x.png").read_bytes().startswith(b"\x89PNG")


def certificate(folder):
    """A self-signed certificate of this machine, and its key."""
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt",
                    "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2", "-subj", "/CN=localhost",
                    "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", folder / "key.pem", "-out",
                    folder / "chain.pem"], check=True, capture_output=True)


def test_websocket_client(tmp_path):
    pytest.importorskip("websockets")
    server = pathlib.Path(os.environ.get("GICODEC_BUILD", "none")) / "tools/stream/gi-server"
    if not server.exists() or not shutil.which("openssl"):
        pytest.skip("GICODEC_BUILD names no build with gi-server")
    _, states = recording(tmp_path / "x.gic", frames=1)
    certificate(tmp_path)
    (tmp_path / "token").write_text("sesame\n")
    process = subprocess.Popen(
        [server, "-q", "--play", tmp_path / "x.gic", "--loop", "--listen-web", "127.0.0.1:0",
         "--certificate", tmp_path / "chain.pem", "--key", tmp_path / "key.pem", "--token-file",
         tmp_path / "token", "--port-file", tmp_path / "port"])
    try:
        for _ in range(300):
            if (tmp_path / "port").exists():
                break
            time.sleep(0.1)
        port = (tmp_path / "port").read_text().split()[0]
        told = run("websocket_client.py", f"wss://127.0.0.1:{port}", "--token-file",
                   tmp_path / "token", "--ca", tmp_path / "chain.pem", "--updates", 12, "--save",
                   tmp_path / "last.npz")
    finally:
        process.terminate()
        process.wait(30)
    arrived = [int(count) for count in re.findall(r"/color, (\d+) blocks", told)]
    assert len(arrived) == 12 and sum(arrived) == 24
    saved = np.load(tmp_path / "last.npz")
    assert {name.split("/")[-1] for name in saved} == {"color", "vis"}
    for name in saved:
        assert saved[name].tobytes() == states[0][name.split("/")[-1]].tobytes()
