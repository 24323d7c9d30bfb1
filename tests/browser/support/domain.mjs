import { spawnSync } from "node:child_process";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { Process } from "./processes.mjs";
import { until } from "./wait.mjs";

const first = 40;
const domains = 60;

/**
 * A DDS domain that no other test of this machine uses while the process that is returned lives, and that no demo used when it was
 * taken; as tests/support/test_domain.h does it, by locks on the same files.
 * @param {string} log
 * @returns {Promise<{ domain: number, keeper: Process }>}
 */
export async function leaseDomain(log) {
  for (let i = 0; i < domains; i += 1) {
    const domain = first + ((process.pid + i) % domains);
    const file = (holder) => join(tmpdir(), `conav-${holder}-${domain}.lock`);
    if (spawnSync("flock", ["-n", file("domain"), "true"]).status !== 0) continue;
    // `cat` waits for the end of its input, which comes with ours.
    const command = ["flock", "-n", file("test"), "sh", "-c", "echo kept; exec cat"];
    const keeper = new Process(`domain ${domain}`, command, {
      log: `${log}-${domain}`,
      stdin: "pipe",
    });
    const kept = await until(`the lock of domain ${domain}`, () => {
      if (keeper.said().includes("kept")) return "yes";
      return keeper.ended === undefined ? undefined : "no";
    });
    if (kept === "yes") return { domain, keeper };
  }
  throw new Error("no DDS domain is free for this test");
}
