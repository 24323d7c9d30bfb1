import { spawnSync } from "node:child_process";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { Process } from "./processes.mjs";
import { until } from "./wait.mjs";

const first = 40;
const domains = 60;

/**
 * Leases a DDS domain that no other test on this machine uses while the returned process lives, and that no demo uses now. Locks
 * the same files as tests/support/test_domain.h.
 * @param {string} log
 * @returns {Promise<{ domain: number, keeper: Process }>}
 */
export async function leaseDomain(log) {
  for (let i = 0; i < domains; i += 1) {
    const domain = first + ((process.pid + i) % domains);
    const file = (holder) => join(tmpdir(), `conav-${holder}-${domain}.lock`);
    if (spawnSync("flock", ["-n", file("domain"), "true"]).status !== 0) continue;
    // `cat` ends with its input, and so with this process.
    const command = ["flock", "-n", file("test"), "sh", "-c", "echo kept; exec cat"];
    const keeper = new Process(`domain ${domain}`, command, {
      log: `${log}-${domain}`,
      stdin: "pipe",
    });
    const kept = await until(`the lock of domain ${domain}`, () => {
      if (keeper.output().includes("kept")) return "yes";
      return keeper.ended === undefined ? undefined : "no";
    });
    if (kept === "yes") return { domain, keeper };
  }
  throw new Error("no DDS domain is free for this test");
}
