import { useConsole } from "./console";
import { TextField } from "./text_field";

/** The person's name, as others see it at commands. Asked for until it is given; `onName` gets each change. */
export function NameField({ name, onName }: { name: string; onName: (name: string) => void }) {
  const { store } = useConsole();
  if (store.name.value !== "") return undefined;
  return (
    <TextField
      label="Your name"
      limit={40}
      autocomplete="name"
      placeholder="Guest"
      value={name}
      onValue={onName}
    >
      <span class="quiet">Others see it at your commands; recordings keep it.</span>
    </TextField>
  );
}
