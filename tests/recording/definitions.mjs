// Message definitions: the readers and writers of a type, and whether it is what ROS 2 itself says.
import { parse } from "@foxglove/rosmsg";
import { ros2jazzy } from "@foxglove/rosmsg-msgs-common";
import { MessageReader, MessageWriter } from "@foxglove/rosmsg2-serialization";

function fields(definitions) {
  return definitions
    .filter((field) => !field.isConstant)
    .map(({ type, name, isArray, arrayLength, arrayUpperBound }) =>
      JSON.stringify([type.replace("/msg/", "/"), name, isArray === true, arrayLength, arrayUpperBound]),
    );
}

function compareWithRos(typeName, definitions) {
  const ros = ros2jazzy[typeName] ?? ros2jazzy[typeName.replace("/msg/", "/")];
  if (ros === undefined) throw new Error(`${typeName}: unknown to ROS`);
  const ours = fields(definitions).join("\n");
  const theirs = fields(ros.definitions).join("\n");
  if (ours !== theirs) throw new Error(`${typeName}:\n${ours}\nis in ROS\n${theirs}`);
}

/** Throws unless every type of the ros2msg `text` that is not conav's own has the fields that ROS 2 gives it. */
export function parseDefinition(typeName, text) {
  const parsed = parse(text, { ros2: true });
  for (const { name, definitions } of parsed) {
    const type = name ?? typeName;
    if (!type.startsWith("conav_msgs/")) compareWithRos(type, definitions);
  }
  return { reader: new MessageReader(parsed), writer: new MessageWriter(parsed) };
}

/** The message in `data`; throws unless it is written back byte for byte. */
export function decode({ reader, writer }, data) {
  const message = reader.readMessage(data);
  const again = writer.writeMessage(message);
  if (Buffer.compare(Buffer.from(again), Buffer.from(data)) !== 0) {
    throw new Error(`${data.length} bytes, written back ${again.length} other ones`);
  }
  return message;
}

/** A message for JSON: 64-bit numbers as numbers, long arrays by their length. */
export function plain(message) {
  return JSON.parse(
    JSON.stringify(message, (_key, value) => {
      if (typeof value === "bigint") return Number(value);
      if (ArrayBuffer.isView(value)) return { length: value.length };
      return value;
    }),
  );
}
