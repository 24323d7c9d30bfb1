import type { ComponentChildren } from "preact";

interface Props {
  label: string;
  /** Of characters. */
  limit: number;
  value: string;
  /** Gets each change. */
  onValue: (value: string) => void;
  placeholder?: string;
  autocomplete?: "name" | "off";
  /** An explanation below the field. */
  children?: ComponentChildren;
}

/** A line of text to fill in, under its label. */
export function TextField({ label, limit, value, onValue, children, ...rest }: Props) {
  return (
    <label class="text-field">
      {label}
      <input
        type="text"
        maxLength={limit}
        value={value}
        onInput={(event) => onValue(event.currentTarget.value)}
        {...rest}
      />
      {children}
    </label>
  );
}
