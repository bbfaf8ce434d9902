"""A reader of CAD files that comes to no end: what it is asked it reads, and then uses its processor time up."""

import pickle
import resource
import sys

if __name__ == "__main__":
    pickle.load(sys.stdin.buffer)
    resource.setrlimit(resource.RLIMIT_CPU, (1, resource.getrlimit(resource.RLIMIT_CPU)[1]))
    while True:
        pass
