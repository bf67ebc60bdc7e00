"""A local HyperQueue cluster, until it is killed: a server in the folder that is named, and so many workers of one core."""

import sys
import time

from hyperqueue import LocalCluster
from hyperqueue.cluster import WorkerConfig

folder, workers = sys.argv[1], int(sys.argv[2])
cluster = LocalCluster(folder)
for _ in range(workers):
    cluster.start_worker(WorkerConfig(cores=1))
with open(f"{folder}/ready", "w") as ready:
    ready.write("ready\n")
while True:
    time.sleep(60)
