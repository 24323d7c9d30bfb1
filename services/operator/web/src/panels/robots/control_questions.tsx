import { useConsole } from "../../app/console";
import { questionsToMe } from "../../state/selectors";
import "./robots.css";

/** Others ask for robots that this page controls: hand over, or keep them. */
export function ControlQuestions() {
  const { store, actions } = useConsole();
  const questions = questionsToMe(store.live.value);
  return (
    <>
      {questions.map(({ client, name, reason, robots }) => (
        <section key={client} class="stage-card question" aria-label="Handover">
          <div>
            <h2>
              {name} asks for control of {robots.join(", ")}
            </h2>
            {reason !== "" && <p>“{reason}”</p>}
          </div>
          <button
            type="button"
            class="main"
            onClick={() => void actions.releaseControl([...robots], client)}
          >
            Hand over
          </button>
          <button type="button" onClick={() => void actions.takeControlNow([...robots], "")}>
            Keep
          </button>
        </section>
      ))}
    </>
  );
}
