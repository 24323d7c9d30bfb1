import { type Picture, PictureAnswer } from "../../protocol/generated/console_pb";
import { CachedLayer } from "../draw/cached_layer";
import type { Draw } from "../draw/context";
import type { Palette } from "../draw/palette";
import type { View } from "../view";
import { drawPictures, type PicturesData } from "./pictures";

/** Of the marks on screen may be of pictures that the page has forgotten: they do no harm, and all others need not be drawn anew. */
const mostForgotten = 0.1;

/** Where pictures were taken. Each one that was answered is drawn once, for there may be thousands; those that wait, in each frame. */
export class PictureMarks {
  #layer = new CachedLayer();
  #drawn = new Set<Picture>();
  #epoch = 0;

  draw(onto: Draw, view: View, { robots, pictures }: PicturesData, palette: Palette): void {
    const waits = ({ answer }: Picture) => answer === PictureAnswer.ANSWER_NONE;
    const settled = pictures.filter((picture) => !waits(picture));
    const fresh = settled.filter((picture) => !this.#drawn.has(picture));
    const forgotten = this.#drawn.size - (settled.length - fresh.length);
    if (forgotten > mostForgotten * settled.length) this.#epoch += 1;
    const looks = robots.map(({ robot, colour }) => `${robot.name} ${colour}`).join();
    const paint = (some: readonly Picture[]) => (on: Draw) => {
      for (const picture of some) this.#drawn.add(picture);
      drawPictures(on, view, { robots, pictures: some }, palette);
    };
    const paintAll = (on: Draw) => {
      this.#drawn.clear();
      paint(settled)(on);
    };
    this.#layer.draw(onto, view, [palette, looks, this.#epoch], paintAll, paint(fresh));
    drawPictures(onto, view, { robots, pictures: pictures.filter(waits) }, palette);
  }
}
