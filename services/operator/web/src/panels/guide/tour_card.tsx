import { useEffect, useRef } from "preact/hooks";
import { useConsole } from "../../app/console";
import { tourStateOf } from "./tour";
import "./guide.css";

/** The current step of the tour. Frames the part of the page that it explains. */
export function TourCard() {
  const { store, tour } = useConsole();
  const number = tour.step.value ?? -1;
  const { steps } = tour;
  const step = steps[number];
  const next = useRef<HTMLButtonElement>(null);
  useFrame(step?.about);
  useEffect(() => {
    if (number === 0) next.current?.focus();
  }, [number]);
  if (step === undefined) return undefined;
  const tourState = tourStateOf(store);
  const ready = step.done === undefined && (step.ready?.(tourState) ?? true);
  const last = number === steps.length - 1;
  return (
    <section class="stage-card" aria-label="Tour">
      <div>
        <h2>
          {step.title}{" "}
          <span class="quiet">
            {number + 1} of {steps.length}
          </span>
        </h2>
        <p>{step.text}</p>
      </div>
      <div class="row">
        <button
          ref={next}
          type="button"
          class={ready ? "main" : ""}
          onClick={() => tour.goOn(tourState)}
        >
          {ready ? (last ? "Done" : "Next") : "Skip"}
        </button>
        {!last && (
          <button type="button" onClick={() => tour.leave()}>
            End the tour
          </button>
        )}
      </div>
    </section>
  );
}

function useFrame(about: string | undefined): void {
  useEffect(() => {
    const framed = about && document.querySelector(`[data-tour="${about}"]`);
    if (!framed) return undefined;
    framed.classList.add("framed");
    return () => framed.classList.remove("framed");
  }, [about]);
}
