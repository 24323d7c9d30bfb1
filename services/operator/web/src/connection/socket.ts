/** The part of a WebSocket that the connection uses. */
export interface Socket {
  send(data: Uint8Array<ArrayBuffer>): void;
  close(): void;
}

export interface SocketEvents {
  opened(): void;
  received(data: ArrayBuffer): void;
  /** Called once, also if the socket never opened. */
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

/** Address of the service that served this page. */
export function serviceUrl(location: { protocol: string; host: string }): string {
  return `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/ws`;
}
