"""launch.py COMMAND...: runs it and adds a line to its standard output: {cpu_s, peak_bytes}.

A child's peak holds what its parent had when it was started, so a large process asks this small one. Standard library alone.
"""

import json
import os
import sys

if __name__ == "__main__":
    child = os.posix_spawnp(sys.argv[1], sys.argv[1:], os.environ)
    _, status, usage = os.wait4(child, 0)
    print(json.dumps({"cpu_s": usage.ru_utime + usage.ru_stime, "peak_bytes": usage.ru_maxrss * 1024}), flush=True)
    sys.exit(os.waitstatus_to_exitcode(status))
