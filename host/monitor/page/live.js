// The WebSocket to the monitor: messages in, commands out, connects again by itself.

const RETRY_MS = 700;

export class Live {
  // hear(message) gets every message, lost() is called when the connection breaks.
  constructor(hear, lost) {
    this.hear = hear;
    this.lost = lost;
    this.socket = null;
    this.connect();
  }

  connect() {
    const key = new URLSearchParams(location.search).get("key") || "";
    const socket = new WebSocket(`ws://${location.host}/live?key=${encodeURIComponent(key)}`);
    socket.onmessage = (event) => {
      for (const message of JSON.parse(event.data)) this.hear(message);
    };
    socket.onclose = () => {
      this.socket = null;
      this.lost();
      setTimeout(() => this.connect(), RETRY_MS);
    };
    socket.onopen = () => { this.socket = socket; };
  }

  // Not queued while the connection is down: an old command to move must never arrive late.
  send(command) {
    const socket = this.socket;
    if (!socket || socket.readyState !== WebSocket.OPEN || socket.bufferedAmount > 2000) return false;
    socket.send(JSON.stringify(command));
    return true;
  }
}
