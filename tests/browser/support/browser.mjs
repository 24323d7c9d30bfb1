import { chromium } from "playwright-core";

/** Debian's own; another one by CONAV_CHROMIUM. */
export const executablePath = process.env.CONAV_CHROMIUM ?? "/usr/bin/chromium";

export const quiet = [
  "--no-sandbox",
  "--disable-gpu",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--no-first-run",
];

export function launch() {
  return chromium.launch({ executablePath, headless: true, args: quiet });
}

/** As a server of its own, whose processes can be told from all others. */
export function launchServer() {
  return chromium.launchServer({ executablePath, headless: true, args: quiet });
}

export function connect(server) {
  return chromium.connect(server.wsEndpoint());
}
