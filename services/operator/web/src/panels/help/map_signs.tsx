import { signs } from "./sign_table";

/** What the map's colours and shapes mean. As `participates` and `offersPaths` of MapProps. */
export function MapSigns(props: { participates: boolean; offersPaths: boolean }) {
  const told = signs
    .filter(({ secret }) => !(secret && props.participates))
    .filter(({ path }) => !path || props.offersPaths);
  return (
    <section class="map-signs">
      <h3>What the map shows</h3>
      <ul>
        {told.map(({ text, sign }) => (
          <li key={text}>
            {sign}
            {text}
          </li>
        ))}
      </ul>
    </section>
  );
}
