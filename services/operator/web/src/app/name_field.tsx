import { useConsole } from "./console";

/** The person's name, as others see it beside commands. Asked for until it is given; `onName` gets each change. */
export function NameField({ name, onName }: { name: string; onName: (name: string) => void }) {
  const { store } = useConsole();
  if (store.name.value !== "") return undefined;
  return (
    <label class="name-field">
      Your name
      <input
        type="text"
        maxLength={40}
        autocomplete="name"
        placeholder="Guest"
        value={name}
        onInput={(event) => onName(event.currentTarget.value)}
      />
      <span class="quiet">Others see it at your commands; recordings keep it.</span>
    </label>
  );
}
