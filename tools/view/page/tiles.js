// The map: a small picture for each tile of cells, drawn again only when the tile has changed.

const UNSEEN = 255, TAKEN_MAX = 100;

export function bytesOf(base64) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(base64);
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

// Colours as bytes in memory, which are the same on every machine that has a browser (little-endian).
function packed([r, g, b, a]) { return ((a << 24) | (b << 16) | (g << 8) | r) >>> 0; }

// free and taken: [r, g, b]. How likely a cell is taken: 0 to 100.
function paletteOf(free, taken) {
  const palette = new Uint32Array(256);
  for (let i = 0; i <= TAKEN_MAX; ++i) {
    const share = i / TAKEN_MAX;
    palette[i] = packed([...free.map((c, k) => Math.round(c + (taken[k] - c) * share)), 255]);
  }
  palette[UNSEEN] = 0;
  return palette;
}

export class Tiles {
  constructor() {
    this.tiles = new Map();
    this.resolution = 0.05;
    this.side = 64;
    this.setColours([255, 255, 255], [0, 0, 0]);
  }

  setColours(free, taken) {
    this.palette = paletteOf(free, taken);
    for (const tile of this.tiles.values()) this.paint(tile);
  }

  // A message of /map/tiles.
  take(message) {
    if (message.fresh) this.tiles.clear();
    this.resolution = message.resolution_m || this.resolution;
    this.side = message.side_cells || this.side;
    for (const {x, y, data} of message.tiles) {
      const key = x + "," + y;
      let tile = this.tiles.get(key);
      if (!tile) {
        const canvas = document.createElement("canvas");
        canvas.width = canvas.height = this.side;
        tile = {x, y, canvas, cells: null};
        this.tiles.set(key, tile);
      }
      tile.cells = bytesOf(data);
      this.paint(tile);
    }
  }

  paint(tile) {
    const side = this.side, context = tile.canvas.getContext("2d");
    const image = context.createImageData(side, side), pixels = new Uint32Array(image.data.buffer);
    for (let y = 0; y < side; ++y) {  // cells grow upwards, pictures downwards
      const from = y * side, to = (side - 1 - y) * side;
      for (let x = 0; x < side; ++x) pixels[to + x] = this.palette[tile.cells[from + x]];
    }
    context.putImageData(image, 0, 0);
  }

  // Edges of neighbours fall on the same pixel of the screen, so that there are no seams.
  draw(context, camera, width, height) {
    const size = this.side * this.resolution;
    context.imageSmoothingEnabled = camera.scale * this.resolution < 1;
    for (const tile of this.tiles.values()) {
      const left = tile.x * this.resolution, bottom = tile.y * this.resolution;
      const x0 = Math.round(camera.screenX(left)), x1 = Math.round(camera.screenX(left + size));
      const y0 = Math.round(camera.screenY(bottom + size)), y1 = Math.round(camera.screenY(bottom));
      if (x1 < 0 || x0 > width || y1 < 0 || y0 > height) continue;
      context.drawImage(tile.canvas, x0, y0, x1 - x0, y1 - y0);
    }
  }

  // [m] of all tiles; null where there are none.
  bounds() {
    if (this.tiles.size === 0) return null;
    let [x0, y0, x1, y1] = [Infinity, Infinity, -Infinity, -Infinity];
    for (const {x, y} of this.tiles.values()) {
      x0 = Math.min(x0, x); y0 = Math.min(y0, y);
      x1 = Math.max(x1, x + this.side); y1 = Math.max(y1, y + this.side);
    }
    return [x0, y0, x1, y1].map(cells => cells * this.resolution);
  }
}
