// Headless Chromium that draws on the processor, and what its processes take (Linux).
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import { pathToFileURL } from 'node:url';

const kTicksPerSecond = 100;  // USER_HZ, what /proc counts in on every architecture that Chromium runs on

function findChromium() {
  const folders = (process.env.PATH ?? '').split(path.delimiter);
  for (const name of ['chromium', 'chromium-browser', 'google-chrome']) {
    for (const folder of folders) if (existsSync(path.join(folder, name))) return path.join(folder, name);
  }
  throw new Error('no chromium in PATH (Debian: apt-get install chromium)');
}

/// {parent, cpu_s} of a process, or null when it has gone.
function processOf(pid) {
  try {
    const fields = readFileSync(`/proc/${pid}/stat`, 'utf8').replace(/^.*\) /s, '').split(' ');
    return { parent: Number(fields[1]), cpu_s: (Number(fields[11]) + Number(fields[12])) / kTicksPerSecond };
  } catch {
    return null;
  }
}

function residentBytes(pid) {
  try {
    return 1024 * Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, 'utf8'))?.[1] ?? 0);
  } catch {
    return 0;
  }
}

/// Renderer and GPU process of the browser whose main process is `root`: the two that load and draw.
function drawingProcesses(root) {
  const all = new Map();
  for (const name of readdirSync('/proc').filter((entry) => /^\d+$/.test(entry))) {
    const found = processOf(name);
    if (found !== null) all.set(Number(name), found);
  }
  const below = (pid) => { for (let at = pid; at > 1; at = all.get(at)?.parent ?? 0) if (at === root) return true; return false; };
  return [...all.keys()].filter((pid) => {
    try {
      return below(pid) && /--type=(renderer|gpu-process)/.test(readFileSync(`/proc/${pid}/cmdline`, 'utf8'));
    } catch {
      return false;
    }
  });
}

/// Promise<{page, faults, use(), close()}>: a browser of its own. use(): {cpu_s, bytes} of the processes that load and draw, or null where
/// there is no /proc. A request to anywhere but this machine is a fault. close() ends the processes at once, under a busy page too.
export async function openBrowser(modules, [width, height]) {
  const { chromium } = await import(pathToFileURL(path.join(modules, 'playwright-core', 'index.mjs')).href);
  const server = await chromium.launchServer({
    executablePath: findChromium(), handleSIGINT: false, handleSIGTERM: false, handleSIGHUP: false,  // the program ends then
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run',
      '--disable-background-networking', '--disable-component-update', '--disable-sync', '--force-color-profile=srgb',
      '--enable-precise-memory-info', '--js-flags=--max-old-space-size=8192', '--disable-gpu-watchdog'],
  });
  const kill = () => server.process().kill('SIGKILL');
  process.on('exit', kill);
  const browser = await chromium.connect(server.wsEndpoint());
  const context = await browser.newContext({ viewport: { width, height }, deviceScaleFactor: 1 });
  const faults = [];
  await context.route((url) => !['127.0.0.1', 'localhost'].includes(url.hostname) && url.protocol.startsWith('http'), (route) => {
    faults.push(`asked for ${route.request().url()}`);
    return route.abort();
  });
  const page = await context.newPage();
  page.setDefaultTimeout(0);  // whoever waits has a limit of its own
  page.on('pageerror', (error) => faults.push(error.message));
  return {
    page, faults,
    use() {
      if (!existsSync('/proc/self/stat')) return null;
      const pids = drawingProcesses(server.process().pid);
      const sum = (of) => pids.reduce((total, pid) => total + of(pid), 0);
      return { cpu_s: sum((pid) => processOf(pid)?.cpu_s ?? 0), bytes: sum(residentBytes) };
    },
    async close() {
      process.off('exit', kill);
      await server.kill();
    },
  };
}
