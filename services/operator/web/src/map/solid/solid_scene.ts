// The world in three dimensions. Metres: x east, y up, z south; the origin is the middle of the grid.
import {
  AmbientLight,
  BoxGeometry,
  BufferGeometry,
  CanvasTexture,
  Color,
  ConeGeometry,
  CylinderGeometry,
  DirectionalLight,
  Group,
  InstancedMesh,
  Line,
  LineBasicMaterial,
  LineSegments,
  type Material,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  PerspectiveCamera,
  PlaneGeometry,
  Scene,
  SphereGeometry,
  Sprite,
  SpriteMaterial,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Palette } from "../draw/palette";
import { shapePath } from "../draw/shapes";
import { Easing } from "../easing";
import { drawLetter } from "../layers/robots";
import type { Cell, MapRobot } from "../map_props";
import { cellPosition, type Placement } from "../view";
import type { SolidData, Wall, WallKind } from "./solid_data";

/** Of a full wall, in cells. */
const wallHeight = 0.6;
/** Length of a view that is drawn, in cells. */
const viewLength = 3;
/** Walls beyond these are left out: more than browsers draw at once. */
const mostWalls = 200_000;
/** ms between two drawings while robots glide. */
const glidePeriod = 40;

export class SolidScene {
  #place: HTMLElement;
  #palette: Palette;
  #renderer: WebGLRenderer;
  #scene = new Scene();
  #camera = new PerspectiveCamera(50, 1, 0.1, 5000);
  #controls: OrbitControls;
  #sizes: ResizeObserver;
  #easing = new Easing();
  #ground = new Group();
  #things = new Group();
  /** Kept: the browser would compile those of a new one for each drawing. */
  #materials = new Map<string, Material>();
  #data: SolidData | undefined;
  #pending: number | undefined;
  #later: ReturnType<typeof setTimeout> | undefined;

  /** Throws where the browser has no WebGL. */
  constructor(place: HTMLElement, palette: Palette) {
    this.#place = place;
    this.#palette = palette;
    this.#renderer = new WebGLRenderer({ antialias: true });
    this.#renderer.setPixelRatio(devicePixelRatio);
    place.append(this.#renderer.domElement);
    this.#scene.background = new Color(palette.paper);
    const sun = new DirectionalLight(0xffffff, 1.6);
    sun.position.set(-0.5, 1, 0.3);
    this.#scene.add(new AmbientLight(0xffffff, 1.4), sun, this.#ground, this.#things);
    this.#controls = new OrbitControls(this.#camera, this.#renderer.domElement);
    this.#controls.maxPolarAngle = 0.49 * Math.PI;
    this.#controls.addEventListener("change", () => this.#request());
    this.#sizes = new ResizeObserver(() => this.#resize());
    this.#sizes.observe(place);
    this.#resize();
  }

  show(data: SolidData): void {
    const before = this.#data;
    this.#data = data;
    const { world, walls } = data;
    const same = before?.world.rows === world.rows && before.world.columns === world.columns;
    if (!same) this.#lookAtAll(world);
    if (!same || before?.walls !== walls) this.#build(world, walls);
    this.#request();
  }

  end(): void {
    if (this.#pending !== undefined) cancelAnimationFrame(this.#pending);
    clearTimeout(this.#later);
    this.#sizes.disconnect();
    this.#controls.dispose();
    clear(this.#ground);
    clear(this.#things);
    for (const material of this.#materials.values()) {
      if (material instanceof SpriteMaterial) material.map?.dispose();
      material.dispose();
    }
    this.#renderer.dispose();
    this.#renderer.forceContextLoss(); // browsers keep few contexts
    this.#renderer.domElement.remove();
  }

  #resize(): void {
    const { clientWidth: width, clientHeight: height } = this.#place;
    if (width === 0 || height === 0) return;
    this.#renderer.setSize(width, height);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    this.#request();
  }

  /** From the south, high enough to see everything. */
  #lookAtAll({ rows, columns, cellSize }: Placement): void {
    const reach = Math.max(rows, columns / Math.max(1, this.#camera.aspect)) * cellSize;
    this.#camera.position.set(0, 0.98 * reach, 0.68 * reach);
    this.#controls.target.set(0, 0, 0);
    this.#controls.update();
  }

  #request(): void {
    this.#pending ??= requestAnimationFrame(() => {
      this.#pending = undefined;
      this.#draw();
    });
  }

  #draw(): void {
    const data = this.#data;
    if (!data) return;
    const { robots, moving } = this.#easing.at(data.robots, performance.now() / 1000);
    clear(this.#things);
    this.#addPaths(data);
    this.#addViews(data);
    for (const one of robots) this.#addRobot(data, one);
    this.#renderer.render(this.#scene, this.#camera);
    if (moving) this.#later = setTimeout(() => this.#request(), glidePeriod);
  }

  // --- Ground and walls ---

  #build(world: Placement, walls: readonly Wall[]): void {
    clear(this.#ground);
    const { rows, columns, cellSize } = world;
    const floor = new Mesh(
      new PlaneGeometry(columns * cellSize, rows * cellSize),
      this.#paint(this.#palette.free),
    );
    floor.rotation.x = -Math.PI / 2;
    this.#ground.add(floor);
    for (const kind of ["belief", "confirmed", "refuted", "missing"] as const) {
      const those = walls.filter((wall) => wall.kind === kind).slice(0, mostWalls);
      if (those.length > 0) this.#ground.add(this.#wallsOf(world, those, kind));
    }
  }

  #wallsOf(world: Placement, walls: readonly Wall[], kind: WallKind): InstancedMesh {
    const { cellSize } = world;
    const colours = {
      belief: this.#palette.muted,
      confirmed: this.#palette.wall,
      refuted: this.#palette.remove,
      missing: this.#palette.differs,
    };
    const material = this.#paint(colours[kind], kind === "confirmed" ? 1 : 0.55);
    const mesh = new InstancedMesh(new BoxGeometry(cellSize, 1, cellSize), material, walls.length);
    const placed = new Matrix4();
    for (const [i, { cell, height }] of walls.entries()) {
      const { x, z } = pointOf(world, cell);
      const full = height * wallHeight * cellSize;
      placed.makeScale(1, full, 1).setPosition(x, full / 2, z);
      mesh.setMatrixAt(i, placed);
    }
    return mesh;
  }

  // --- Robots and what belongs to them ---

  #addRobot({ world, chosenRobot }: SolidData, one: MapRobot): void {
    const { robot, colour, stopped } = one;
    const radius = 0.3 * world.cellSize;
    const body = new Group();
    const paint = this.#paint(colour);
    const base = new Mesh(new CylinderGeometry(radius, radius, 0.6 * radius, 24), paint);
    base.position.y = 0.3 * radius;
    const nose = new Mesh(new ConeGeometry(0.45 * radius, 1.1 * radius, 16), paint);
    nose.rotation.z = -Math.PI / 2;
    nose.position.set(1.2 * radius, 0.4 * radius, 0);
    body.add(base, nose);
    if (stopped || robot.name === chosenRobot) {
      const state = stopped ? this.#palette.refused : this.#palette.focus;
      const ring = new Mesh(
        new CylinderGeometry(1.5 * radius, 1.5 * radius, 0.1 * radius, 32),
        this.#paint(state),
      );
      ring.position.y = 0.05 * radius;
      body.add(ring);
    }
    body.position.set(robot.x - world.middleX, 0, -(robot.y - world.middleY));
    body.rotation.y = robot.heading;
    const mark = new Sprite(this.#markOf(one));
    mark.scale.setScalar(2 * radius);
    mark.position.set(body.position.x, 2.4 * radius, body.position.z);
    this.#things.add(body, mark);
    for (const goal of robot.goalsLeft) this.#things.add(this.#goalAt(world, goal, colour));
  }

  #addPaths({ world, robots, paths }: SolidData): void {
    for (const { robot, colour } of robots) {
      const path = paths.get(robot.name) ?? [];
      if (path.length < 2) continue;
      const points = path.map((cell) => pointOf(world, cell, 0.06));
      const line = new BufferGeometry().setFromPoints(points);
      this.#things.add(new Line(line, this.#ink(colour)));
    }
  }

  /** The view of each robot's newest picture, as a frustum. */
  #addViews({ world, robots, newest }: SolidData): void {
    for (const { robot, cell, heading, fieldOfView, width, height } of newest) {
      const colour = robots.find((one) => one.robot.name === robot)?.colour ?? "#808080";
      if (!cell) continue;
      const from = pointOf(world, cell, 0.25);
      const length = viewLength * world.cellSize;
      const rise = length * Math.tan(fieldOfView / 2) * (width > 0 ? height / width : 0.6);
      const corners = [-1, 1].flatMap((side) =>
        [-1, 1].map((up) => {
          const angle = heading + (side * fieldOfView) / 2;
          const y = Math.max(0.05, from.y + 0.3 * up * rise);
          return new Vector3(
            from.x + length * Math.cos(angle),
            y,
            from.z - length * Math.sin(angle),
          );
        }),
      );
      const [a, b, c, d] = corners;
      if (!a || !b || !c || !d) continue;
      const edges = [from, a, from, b, from, c, from, d, a, b, c, d, a, c, b, d];
      const lines = new BufferGeometry().setFromPoints(edges);
      this.#things.add(new LineSegments(lines, this.#ink(colour)));
    }
  }

  #goalAt(world: Placement, cell: Cell, colour: string): Mesh {
    const ball = new Mesh(new SphereGeometry(0.16 * world.cellSize, 16, 12), this.#paint(colour));
    ball.position.copy(pointOf(world, cell, 0.35));
    return ball;
  }

  // --- Materials ---

  #paint(color: string, opacity = 1): Material {
    const transparent = opacity < 1;
    return this.#material(`${color} ${opacity}`, () => {
      return new MeshLambertMaterial({ color, transparent, opacity });
    });
  }

  #ink(color: string): Material {
    return this.#material(`line ${color}`, () => new LineBasicMaterial({ color }));
  }

  /** The robot's mark, as on the map. */
  #markOf(one: MapRobot): SpriteMaterial {
    const { letter, colour, shape } = one;
    return this.#material(`mark ${letter} ${colour} ${shape}`, () => {
      const middle = { x: 32, y: 32 };
      const picture = document.createElement("canvas");
      picture.width = picture.height = 64;
      const context = picture.getContext("2d");
      if (context) {
        context.fillStyle = colour;
        shapePath(context, shape, middle, 25);
        context.fill();
        drawLetter(context, middle, one, 30);
      }
      return new SpriteMaterial({ map: new CanvasTexture(picture) });
    });
  }

  #material<Kind extends Material>(key: string, make: () => Kind): Kind {
    const kept = (this.#materials.get(key) as Kind | undefined) ?? make();
    this.#materials.set(key, kept);
    return kept;
  }
}

/** The middle of a cell; `up` in cells. */
function pointOf(world: Placement, cell: Cell, up = 0): Vector3 {
  const { x, y } = cellPosition(world, cell);
  return new Vector3(x - world.middleX, up * world.cellSize, -(y - world.middleY));
}

/** Removes everything from a group, and its shapes from the graphics memory. */
function clear(group: Group): void {
  group.traverse((thing) => {
    if (!(thing instanceof Mesh || thing instanceof Line)) return;
    thing.geometry.dispose();
    if (thing instanceof InstancedMesh) thing.dispose();
  });
  group.clear();
}
