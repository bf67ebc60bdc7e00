"""What `hq submit --wait --array 0-N … -- COMMAND` does, for a machine that has the Python wheel of HyperQueue and not its program:
the wheel has a server and workers, and no command line. The server is that of the folder $HQ_SERVER_DIR."""

import os
import sys

from hyperqueue import Job
from hyperqueue.client import Client

words = sys.argv[1:]
split = words.index("--")
assert words[0] == "submit" and "--wait" in words[:split], words
first, last = map(int, words[words.index("--array") + 1].split("-"))
client = Client(os.environ["HQ_SERVER_DIR"])
job = Job(max_fails=None)
for _ in range(first, last + 1):
    job.program(words[split + 1 :], cwd=os.getcwd(), stdout=None, stderr=None)
sys.exit(0 if client.wait_for_jobs([client.submit(job)], raise_on_error=False) else 1)
