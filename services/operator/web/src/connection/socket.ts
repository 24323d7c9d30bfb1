/** What the connection needs of a WebSocket. */
export interface Socket {
  send(data: Uint8Array<ArrayBuffer>): void;
  close(): void;
}

export interface SocketEvents {
  opened(): void;
  received(data: ArrayBuffer): void;
  /** Once, also when it never opened. */
  closed(): void;
}

export type SocketFactory = (events: SocketEvents) => Socket;

export function webSocketFactory(url: string): SocketFactory {
  return (events) => {
    const socket = new WebSocket(url);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => events.opened();
    socket.onclose = () => events.closed();
    socket.onmessage = ({ data }) => {
      if (data instanceof ArrayBuffer) events.received(data);
    };
    return {
      send: (data) => {
        if (socket.readyState === WebSocket.OPEN) socket.send(data);
      },
      close: () => socket.close(),
    };
  };
}

/** The service that this page came from. */
export function serviceUrl(location: { protocol: string; host: string }): string {
  return `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/ws`;
}
