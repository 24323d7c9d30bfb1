/**
 * Moves a page's map for `seconds` as a person does, with a drag and then with the wheel, one event per animation frame, at a
 * few zooms from the whole map to single cells. Shows the whole map afterwards.
 * @param {number} seconds
 * @returns {string} a script for the page; its value is the ms between animation frames: { pan: number[], zoom: number[] }
 */
export function frameProbe(seconds) {
  return `(${probe})(${seconds})`;
}

/** Runs in the page. */
async function probe(seconds) {
  const canvas = document.querySelector("canvas[role=application]");
  const middle = { x: canvas.clientWidth / 2, y: canvas.clientHeight / 2 };
  const fire = (Kind, type, at, more) => {
    const { left, top } = canvas.getBoundingClientRect();
    const place = { clientX: left + at.x, clientY: top + at.y, bubbles: true, cancelable: true };
    canvas.dispatchEvent(new Kind(type, { pointerId: 1, pointerType: "mouse", ...place, ...more }));
  };
  const zoom = (deltaY) => fire(WheelEvent, "wheel", middle, { deltaY });
  const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
  /** Ms between frames while `act` is called once in each. */
  const timed = async (share, act) => {
    const times = [];
    await frame();
    let last = performance.now();
    const end = last + 1000 * seconds * share;
    for (let number = 0; last < end; number += 1) {
      act(number);
      await frame();
      const now = performance.now();
      times.push(now - last);
      last = now;
    }
    return times;
  };
  const drag = (number) =>
    fire(PointerEvent, "pointermove", {
      x: middle.x + 0.25 * canvas.clientWidth * Math.sin(number / 20),
      y: middle.y + 0.25 * canvas.clientHeight * Math.sin(number / 13),
    });
  // A synthetic pointer cannot be captured.
  canvas.setPointerCapture = () => undefined;
  const pan = [];
  const zooms = [300, 900, 1500]; // of the wheel: 1.6, 6 and 60 times the whole map
  for (const wheel of zooms) {
    zoom(-wheel);
    fire(PointerEvent, "pointerdown", middle, { button: 1, buttons: 4 });
    pan.push(...(await timed(0.5 / zooms.length, drag)));
    fire(PointerEvent, "pointerup", middle, { button: 1 });
  }
  zoom(10000);
  const inAndOut = (number) => zoom(number % 120 < 60 ? -50 : 50);
  const zoomed = await timed(0.5, inAndOut);
  zoom(10000); // for those who measure where robots are on the whole map
  return { pan, zoom: zoomed };
}
