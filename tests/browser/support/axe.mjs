import assert from "node:assert/strict";
import axe from "axe-core";

/** Nothing serious. In both themes, without transitions, which would change the contrast. */
export async function finds(page, state) {
  for (const theme of ["dark", "light"]) {
    await page.page.emulateMedia({ colorScheme: theme, reducedMotion: "reduce" });
    await page.page.locator(`html[data-theme=${theme}]`).waitFor();
    await page.page.evaluate(axe.source);
    const { violations, passes } = await page.page.evaluate(() => globalThis.axe.run());
    assert.ok(passes.length > 10, "axe has looked");
    const grave = violations.filter(({ impact }) => impact === "serious" || impact === "critical");
    assert.deepEqual(grave.map(inWords), [], `${state}, ${theme}`);
  }
}

function inWords({ id, help, nodes }) {
  return `${id}: ${help}: ${nodes.map(({ html }) => html.slice(0, 150)).join(" | ")}`;
}
