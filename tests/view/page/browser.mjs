// Chromium, driven by lines of JSON: node browser.mjs MODULES
//   MODULES  folder with node_modules/playwright-core
// Each line of standard input is a command, each line of standard output its answer: {"value"} or {"error"}.
import { createRequire } from 'node:module';
import path from 'node:path';
import readline from 'node:readline';

const { chromium } = createRequire(path.resolve(process.argv[2], 'package.json'))('playwright-core');

// SwiftShader draws without a graphics card. A container often forbids Chromium's own sandbox.
const browser = await chromium.launch({
  executablePath: '/usr/bin/chromium',
  args: [
    '--no-sandbox',
    '--use-angle=swiftshader',
    '--enable-unsafe-swiftshader',
    '--disable-background-networking',
  ],
});
let page = null;
let errors = []; // of the page's scripts
let hosts = new Set(); // that the page asked

/** Cuts the first message of the first connection that has over 10,000 bytes: a frame of the map. */
async function cutOne(context) {
  let isDone = false;
  await context.routeWebSocket(/.*/, (client) => {
    const server = client.connectToServer();
    client.onMessage((message) => server.send(message));
    server.onMessage((message) => {
      const isCut = !isDone && typeof message !== 'string' && message.length > 10000;
      isDone ||= isCut;
      client.send(isCut ? message.subarray(0, message.length - 5) : message);
    });
  });
}

async function open({ url, width, height, scheme, cuts }) {
  await page?.context().close();
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: scheme });
  if (cuts) await cutOne(context);
  page = await context.newPage();
  errors = [];
  hosts = new Set();
  page.on('pageerror', (error) => errors.push(error.stack));
  page.on('console', (message) => message.type() === 'error' && errors.push(message.text()));
  page.on('request', (request) => hosts.add(new URL(request.url()).host));
  page.on('websocket', (socket) => hosts.add(new URL(socket.url()).host));
  await page.goto(url);
}

const COMMANDS = {
  open,
  evaluate: ({ expression }) => page.evaluate(expression),
  press: ({ key }) => page.keyboard.press(key),
  click: ({ x, y }) => page.mouse.click(x, y),
  screenshot: ({ file }) => page.screenshot({ path: file }).then(() => file),
  seen: () => ({ errors, hosts: [...hosts] }),
};

for await (const line of readline.createInterface({ input: process.stdin })) {
  const command = JSON.parse(line);
  try {
    const value = await COMMANDS[command.do](command);
    console.log(JSON.stringify({ value: value ?? null }));
  } catch (error) {
    console.log(JSON.stringify({ error: String(error) }));
  }
}
await browser.close();
