// The types of the helpers that make elements (common/dom.js, widgets/svg.js).

/** A child of an element; null, undefined, false and '' are left out. */
export type Child = Node | string | number | boolean | null | undefined | readonly Child[];

type Value = string | number | boolean | null | undefined;

/** Attributes and, with names that begin with `on`, event handlers. */
export type Properties<E extends Element = HTMLElement> = {
  [K in keyof HTMLElementEventMap as `on${K}`]?:
    ((event: HTMLElementEventMap[K] & {currentTarget: E}) => unknown) | false | null;
} & {[attribute: string]: Value | ((event: never) => unknown)};

/** The element that a tag makes. */
export type ElementOf<K extends string> = K extends keyof HTMLElementTagNameMap
  ? HTMLElementTagNameMap[K]
  : K extends keyof SVGElementTagNameMap
    ? SVGElementTagNameMap[K]
    : HTMLElement;
