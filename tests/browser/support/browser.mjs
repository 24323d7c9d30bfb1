import { chromium } from "playwright-core";

/** Debian's Chromium, or CONAV_CHROMIUM. */
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

/** A browser server with its own processes. */
export function launchServer() {
  return chromium.launchServer({ executablePath, headless: true, args: quiet });
}

export function connect(server) {
  return chromium.connect(server.wsEndpoint());
}
