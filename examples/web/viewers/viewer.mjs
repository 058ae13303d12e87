// What a viewer is. Every adapter in this folder exports `create(canvas, options)`, which returns an object with:
//
//   name, version                 of the library
//   load(source)                  Promise<{duration_s}>; source: URL or ArrayBuffer (.glb); replaces what was loaded
//   seek(time_s)                  any order, forwards and backwards; clamped to the timeline
//   frame()                       places the camera so that the whole scene is seen
//   setCamera({eye_m, target_m, yfov_rad}), getCamera()
//   resize(width, height)         in pixels of the image
//   draw()                        now, as for a screen
//   render()                      Promise; the image of the time sought is complete afterwards
//   pixels()                      {width, height, data}: RGBA, first row on top; renders
//   dispose()
//
// options:
//   background  [r, g, b] in 0 … 255 (sRGB); none: transparent
//   flat        true: colours as they stand in the file, no light and shade (for tests on pixels)
//   controls    true: orbit with mouse or fingers
//   antialias   false: one sample a pixel
//   shadows     false: the sun throws none
//   plainLight  true: a sun and a sky, and no picture of surroundings in which surfaces are mirrored
//   decoders    folder URL of the Draco decoders (server.mjs says where they come from); default 'vendor/'

export const kDefaults = { background: null, flat: false, controls: false, antialias: true, shadows: true, plainLight: false, decoders: 'vendor/' };

/// The default framebuffer of a WebGL context, read in the task that drew it. GL's rows start at the bottom.
export function readPixels(gl) {
  const width = gl.drawingBufferWidth, height = gl.drawingBufferHeight;
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  const upsideDown = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, upsideDown);
  const data = new Uint8ClampedArray(upsideDown.length);
  for (let row = 0; row < height; row += 1) {
    data.set(upsideDown.subarray(4 * width * (height - 1 - row), 4 * width * (height - row)), 4 * width * row);
  }
  return { width, height, data };
}

/// An eye that sees a ball whole at this shape of picture, from the front right, somewhat above.
export function eyeAround(center_m, radius_m, yfov_rad, aspect) {
  const narrow = Math.min(yfov_rad, 2 * Math.atan(Math.tan(yfov_rad / 2) * aspect));
  const fill = aspect > 1 ? 0.88 : 1;  // a box does not fill its ball
  const distance = fill * Math.max(radius_m, 1e-6) / Math.sin(narrow / 2);
  const direction = [0.62, 0.42, 0.66];
  return center_m.map((value, axis) => value + distance * direction[axis] / Math.hypot(...direction));
}
