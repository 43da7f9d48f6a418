// A client of Foxglove's WebSocket protocol that connects again when the connection ends.

const SUBPROTOCOLS = ['foxglove.sdk.v1', 'foxglove.websocket.v1'];
const OPCODE = { message: 1, request: 2, response: 3, asset: 4 };
const RETRY_MS = 1000;
const ANSWER_MS = 30000;

/** @typedef {{topic: string, buffer: ArrayBuffer, offset: number}} Message its payload begins at `offset` */

export class Connection {
  /**
   * @param {string} url ws://...
   * @param {{onState: function(string), onServer: function(object)}} hears state: connecting, connected, lost
   */
  constructor(url, { onState, onServer }) {
    this.url = url;
    this.onState = onState;
    this.onServer = onServer;
    this.handlers = []; // {matches, handle}
    this.calls = new Map();
    this.nextCall = 1;
    this.counts = { connections: 0, messages: 0, bytes: 0, malformed: 0 };
  }

  /**
   * Messages of these topics go to `handle`. To be called before `open`.
   * @param {RegExp} topics @param {function(Message)} handle
   */
  wants(topics, handle) {
    this.handlers.push({ topics, handle });
  }

  open() {
    this.onState('connecting');
    this.topics = new Map(); // subscription id -> {topic, handle}
    this.services = new Map(); // name -> id
    this.hasAssets = false;
    this.socket = new WebSocket(this.url, SUBPROTOCOLS);
    this.socket.binaryType = 'arraybuffer';
    this.socket.onmessage = ({ data }) => this.#take(data);
    this.socket.onclose = () => this.#lost();
  }

  /** Ends the connection; it is opened again as after a loss. */
  reopen() {
    this.socket.close();
  }

  #lost() {
    for (const { reject } of this.calls.values()) reject(new Error('the connection to octoskin ended'));
    this.calls.clear();
    this.onState('lost');
    setTimeout(() => this.open(), RETRY_MS);
  }

  #take(data) {
    this.counts.messages += 1;
    this.counts.bytes += data.byteLength ?? data.length;
    try {
      if (typeof data === 'string') this.#takeText(JSON.parse(data));
      else this.#takeBinary(data);
    } catch (error) {
      if (!(error instanceof RangeError || error instanceof SyntaxError)) throw error;
      this.counts.malformed += 1;
    }
  }

  #takeText(message) {
    if (message.op === 'serverInfo') {
      this.counts.connections += 1;
      this.hasAssets = message.capabilities?.includes('assets') ?? false;
      this.onServer(message);
      this.onState('connected');
    } else if (message.op === 'advertise') this.#subscribe(message.channels);
    else if (message.op === 'unadvertise') for (const id of message.channelIds) this.topics.delete(id);
    else if (message.op === 'advertiseServices')
      for (const { id, name } of message.services) this.services.set(name, id);
    else if (message.op === 'serviceCallFailure') this.#settle(message.callId, { failure: message.message });
  }

  /** A subscription has the number of its channel. */
  #subscribe(channels) {
    const subscriptions = [];
    for (const { id, topic } of channels) {
      const handler = this.handlers.find(({ topics }) => topics.test(topic));
      if (!handler || this.topics.has(id)) continue;
      this.topics.set(id, { topic, handle: handler.handle });
      subscriptions.push({ id, channelId: id });
    }
    if (subscriptions.length > 0) this.socket.send(JSON.stringify({ op: 'subscribe', subscriptions }));
  }

  #takeBinary(buffer) {
    const view = new DataView(buffer);
    const opcode = view.getUint8(0);
    if (opcode === OPCODE.message) {
      const channel = this.topics.get(view.getUint32(1, true));
      channel?.handle({ topic: channel.topic, buffer, offset: 13 });
    } else if (opcode === OPCODE.response) {
      const encodingLength = view.getUint32(9, true);
      const text = new TextDecoder().decode(new Uint8Array(buffer, 13 + encodingLength));
      this.#settle(view.getUint32(5, true), { answer: JSON.parse(text) });
    } else if (opcode === OPCODE.asset) this.#takeAsset(view);
  }

  #takeAsset(view) {
    const [request, status, length] = [view.getUint32(1, true), view.getUint8(5), view.getUint32(6, true)];
    const failure = new TextDecoder().decode(new Uint8Array(view.buffer, 10, length));
    this.#settle(request, status === 0 ? { answer: view.buffer.slice(10 + length) } : { failure });
  }

  #settle(call, { answer, failure }) {
    const waiting = this.calls.get(call);
    if (!waiting) return;
    this.calls.delete(call);
    clearTimeout(waiting.timer);
    if (failure === undefined) waiting.resolve(answer);
    else waiting.reject(new Error(failure));
  }

  offers(service) {
    return this.services?.has(service) ?? false;
  }

  /** @param {string} service @param {object} request @returns {Promise<object>} rejected with a sentence */
  call(service, request) {
    const id = this.services?.get(service);
    if (id === undefined || this.socket.readyState !== WebSocket.OPEN)
      return Promise.reject(new Error('octoskin is not connected'));
    const call = this.nextCall++;
    const encoding = new TextEncoder().encode('json');
    const payload = new TextEncoder().encode(JSON.stringify(request));
    const bytes = new Uint8Array(13 + encoding.length + payload.length);
    const view = new DataView(bytes.buffer);
    view.setUint8(0, OPCODE.request);
    view.setUint32(1, id, true);
    view.setUint32(5, call, true);
    view.setUint32(9, encoding.length, true);
    bytes.set(encoding, 13);
    bytes.set(payload, 13 + encoding.length);
    this.socket.send(bytes);
    return new Promise((resolve, reject) => {
      const timer = setTimeout(
        () => this.#settle(call, { failure: `no answer within ${ANSWER_MS / 1000} s` }),
        ANSWER_MS,
      );
      this.calls.set(call, { resolve, reject, timer });
    });
  }

  /** A file that the server has, as a mesh of the robot. @returns {Promise<ArrayBuffer>} rejected with a sentence */
  fetchAsset(uri) {
    if (this.socket.readyState !== WebSocket.OPEN) return Promise.reject(new Error('octoskin is not connected'));
    if (!this.hasAssets) return Promise.reject(new Error('octoskin serves no files'));
    const requestId = this.nextCall++;
    this.socket.send(JSON.stringify({ op: 'fetchAsset', uri, requestId }));
    // However long it takes: the server cannot be stopped from sending a file.
    return new Promise((resolve, reject) => this.calls.set(requestId, { resolve, reject }));
  }
}

/** The JSON of a message. Throws a SyntaxError. @param {Message} message */
export function jsonOf({ buffer, offset }) {
  return JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, offset)));
}
