// node tests/foxglove/measure.mjs URL PID [SECONDS]: processor time of the operator service PID without clients, then with
// 1 and 8 that subscribe to all topics of URL, and what one of them got per second.
import { setTimeout as pause } from "node:timers/promises";
import protocol from "@foxglove/ws-protocol";
import WebSocket from "ws";
import { cpuOf } from "../browser/support/processes.mjs";

const [, , url, pid, seconds = "20"] = process.argv;
const clients = [];
let messages = 0;
let bytes = 0;

function open() {
  const client = new protocol.FoxgloveClient({ ws: new WebSocket(url, ["foxglove.sdk.v1"]) });
  client.on("advertise", (channels) => {
    for (const { id } of channels) client.subscribe(id);
  });
  if (clients.push(client) > 1) return;
  client.on("message", ({ data }) => {
    messages += 1;
    bytes += data.byteLength;
  });
}

for (const count of [0, 1, 8]) {
  while (clients.length < count) open();
  await pause(3000);
  [messages, bytes] = [0, 0];
  const [cpu, since] = [cpuOf(pid), Date.now()];
  await pause(1000 * Number(seconds));
  const passed = (Date.now() - since) / 1000;
  const share = (100 * (cpuOf(pid) - cpu)) / passed;
  const perSecond = (sum) => Math.round(sum / passed);
  console.log(
    `${count} clients: ${share.toFixed(1)} % of a core; a client gets ${perSecond(messages)} messages and ${perSecond(bytes / 1024)} KiB/s`,
  );
}
for (const client of clients) client.close();
