// Debian's Chromium through playwright-core, drawing on the processor. Nothing outside of this machine is asked for.
import { existsSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import { chromium } from 'playwright-core';

function findChromium() {
  const names = ['chromium', 'chromium-browser', 'google-chrome'];
  const folders = (process.env.PATH ?? '').split(path.delimiter);
  for (const name of names) for (const folder of folders) if (existsSync(path.join(folder, name))) return path.join(folder, name);
  throw new Error('no chromium in PATH: tools/setup.sh test installs it');
}

/// Promise<{faults, page(size), close()}>. A request to anywhere but this machine is a failure, and so is a page error. close() ends the
/// browser's processes at once, also under a page that is busy and would not answer.
export async function openBrowser() {
  const server = await chromium.launchServer({
    executablePath: findChromium(),
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run',
      '--disable-background-networking', '--disable-component-update', '--disable-sync', '--force-color-profile=srgb'],
  });
  const browser = await chromium.connect(server.wsEndpoint());
  const faults = [];
  return {
    faults,
    async page(width, height, options = {}) {
      const context = await browser.newContext({ viewport: { width, height }, deviceScaleFactor: 1, ...options });
      await context.route((url) => !['127.0.0.1', 'localhost'].includes(url.hostname) && url.protocol.startsWith('http'), (route) => {
        faults.push(`asked for ${route.request().url()}`);
        return route.abort();
      });
      const page = await context.newPage();
      page.setDefaultTimeout(120_000);
      page.on('pageerror', (error) => faults.push(`page: ${error.message}`));
      return page;
    },
    close: () => server.kill(),
  };
}
