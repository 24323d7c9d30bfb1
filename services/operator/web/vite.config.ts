import { defineConfig } from "vitest/config";

// `npm run build -- --outDir DIR`; the build of conav calls it so.
export default defineConfig({
  esbuild: { jsx: "automatic", jsxImportSource: "preact" },
  build: { target: "es2022", sourcemap: false, assetsInlineLimit: 0, chunkSizeWarningLimit: 1600 },
  server: {
    proxy: {
      "/ws": { target: "ws://127.0.0.1:8080", ws: true },
      "/pictures": "http://127.0.0.1:8080",
    },
  },
  // Files share a process and what they import: a sixth of the time. In any order: --sequence.shuffle.files
  test: { include: ["src/**/*.test.{ts,tsx}"], environment: "node", isolate: false },
});
