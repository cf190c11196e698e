// Number and size of the virtual camera's pictures.

export const count = 7;
export const size = {width: 640, height: 480};
