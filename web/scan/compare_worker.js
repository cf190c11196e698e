// A worker that compares a model with a reference, which takes seconds.

import {deviations} from '../model/deviation.js';

onmessage = ({data: {model, reference, isPlaced}}) => {
  const {distances, weights} = deviations(model, reference, {isPlaced});
  postMessage({distances, weights}, {transfer: [distances.buffer, weights.buffer]});
};
