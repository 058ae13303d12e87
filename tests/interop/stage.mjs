// A page in Chromium in which one viewer after the other plays our files.
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { openBrowser } from './browser.mjs';

/// `source`: root of the project; `here`: the folder with node_modules; `files`: folder of the files to be played.
export async function openStage({ source, here, files, size }) {
  const { serve } = await import(pathToFileURL(path.join(source, 'examples', 'web', 'server.mjs')).href);
  const server = await serve({
    scripts: { '/page.js': path.join(source, 'tests', 'interop', 'viewer_page.mjs') },
    folders: { '/': path.join(source, 'tests', 'interop'), '/files/': files }, modules: path.join(here, 'node_modules'),
  });
  const browser = await openBrowser();
  const page = await browser.page(...size);
  await page.goto(`${server.url}/viewer_page.html`);
  await page.waitForFunction(() => window.ready === true);
  return {
    page,
    faults: browser.faults,
    /// Promise<'three.js 187'>
    open: (viewer, options) => page.evaluate((args) => window.open_viewer(...args), [viewer, size, { decoders: '/vendor/', ...options }]),
    load: (file) => page.evaluate((url) => window.viewer.load(url), `/files/${encodeURIComponent(path.relative(files, file))}`),
    setCamera: (camera) => page.evaluate((key) => window.viewer.setCamera(key), camera),
    async shot(time_s) {
      const image = await page.evaluate((at) => window.shot(at), time_s);
      return { ...image, data: Buffer.from(image.data, 'base64') };
    },
    async close() {
      await browser.close();
      await server.close();
    },
  };
}
